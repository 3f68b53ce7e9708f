#pragma once
// Operands for double-float's searches: random, with deliberately awkward ones in their midst.

#include <cmath>
#include <cstdint>
#include <random>

#include "common/numerics/double_float.h"
#include "tests/support/high_precision.h"

namespace terrane::test {

inline HighPrecision exact(const DoubleFloat& x) { return HighPrecision(x.hi) + HighPrecision(x.lo); }

class DoubleFloatOperands {
 public:
  explicit DoubleFloatOperands(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits(int count) { return engine_() >> (64 - count); }

  /// A float with exponent in [low, high]; its mantissa is often close to 1 or to 2, where relative errors peak.
  float single(int low, int high) {
    const std::uint64_t kind = bits(2);
    std::uint64_t mantissa = bits(23);
    if (kind == 0) mantissa = bits(3);
    if (kind == 1) mantissa = 0x7fffff - bits(3);
    const int exponent = low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
    const float magnitude = std::ldexp(1.0f + std::ldexp(static_cast<float>(mantissa), -23), exponent);
    return bits(1) ? -magnitude : magnitude;
  }

  /// A normalised pair; its low word is often as large as it may be, sometimes tiny or 0.
  DoubleFloat pair(int low, int high) {
    const float hi = single(low, high);
    const int exponent = std::ilogb(hi) - 24;
    const std::uint64_t kind = bits(3);
    float lo = single(exponent - 1, exponent - 1);
    if (kind == 0) lo = single(exponent - 20, exponent - 1);
    if (kind == 1) lo = 0.0f;
    if (kind == 2) lo = std::copysign(std::ldexp(1.0f, exponent) * (1.0f - 0x1p-24f), lo);
    return twoSum(hi, lo);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace terrane::test

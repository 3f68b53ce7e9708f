#pragma once
// The search for a double-float operation's worst error: operands at random and deliberately awkward, and an arithmetic
// of 113 bits to compare with.

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdint>
#include <limits>
#include <random>

#include "common/numerics/double_float.h"

namespace terrane::test {

using Quad = boost::multiprecision::cpp_bin_float_quad;
using Limits = std::numeric_limits<float>;

inline constexpr int kSamples = 100000;

inline Quad exact(const DoubleFloat& x) { return Quad(x.hi) + Quad(x.lo); }

inline bool isNormalised(const DoubleFloat& x) { return x.hi + x.lo == x.hi; }

class Operands {
 public:
  /// Prints the seed.
  explicit Operands(std::uint64_t seed);

  std::uint64_t bits(int count) { return engine_() >> (64 - count); }
  /// A float with exponent in [low, high]; its mantissa is often close to 1 or to 2, where relative errors peak.
  float single(int low, int high);
  /// A normalised pair; its low word is often as large as it may be, sometimes tiny or 0.
  DoubleFloat pair(int low, int high);

 private:
  std::mt19937_64 engine_;
};

}  // namespace terrane::test

#pragma once
// 2^exponent, exactly. ldexp is a call, in loops over vertices and cells. Thread-safe.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/numerics/strict_math.h"

namespace terrane {

inline double powerOfTwo(int exponent) noexcept {
  constexpr int kLeast = std::numeric_limits<double>::min_exponent - 1,
                kMost = std::numeric_limits<double>::max_exponent - 1;
  if (exponent < kLeast || exponent > kMost) return std::ldexp(1.0, exponent);
  constexpr int kBias = kMost, kFractionBits = std::numeric_limits<double>::digits - 1;
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kBias) << kFractionBits);
}

}  // namespace terrane

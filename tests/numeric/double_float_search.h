#pragma once
// The search for a double-float operation's worst error.

#include <cstdint>
#include <limits>

#include "common/numerics/double_float.h"
#include "tests/support/double_float_operands.h"
#include "tests/support/sanitizers.h"

namespace terrane::test {

using Limits = std::numeric_limits<float>;

inline constexpr int kSamples = 100000;

/// Sanitizers look for what is undefined, which a tenth finds too; how near the bounds come is for other builds.
inline constexpr bool kSearchIsFull = !kAddressSanitizer;
/// For each operation; half of them close in on the worst of the other half.
inline constexpr std::size_t kSearchSamples = kSearchIsFull ? 600000 : 60000;

inline bool isNormalised(const DoubleFloat& x) { return x.hi + x.lo == x.hi; }

class Operands : public DoubleFloatOperands {
 public:
  /// Prints the seed.
  explicit Operands(std::uint64_t seed);
};

}  // namespace terrane::test

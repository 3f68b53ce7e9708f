#include "common/tiling/lattice.h"

#include <bit>
#include <cmath>
#include <limits>

#include "common/numerics/strict_math.h"
#include "common/tiling/icosahedron.h"

namespace terrane {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

/// Nearest integer, halves up. floor(x + 0.5) is wrong for 0.5 - 2^-54 and others, since the sum rounds; the difference
/// below decides rightly for every x, by the monotony of rounding.
/// Through an integer, because std::floor is a call on the oldest x86-64.
std::int64_t roundHalfUp(double x) noexcept {
  const auto towardsZero = static_cast<std::int64_t>(x);
  const std::int64_t lower = towardsZero - (static_cast<double>(towardsZero) > x ? 1 : 0);
  return lower + (x - static_cast<double>(lower) >= 0.5 ? 1 : 0);
}

}  // namespace

double nominalTileWidthMeters(double radiusMeters, int level, Scheme scheme) noexcept {
  return std::ldexp((scheme == Scheme::Ico ? kIcosahedronEdgeAngle : kHalfPi) * radiusMeters, -level);
}

int stepExponent(double radiusMeters, int level, Scheme scheme) noexcept {
  // frexp and ldexp are exact. W / 2^15 = fraction 2^exponent with the fraction in [1/2, 1): only a power of two itself
  // rounds up to exponent - 1.
  int exponent = 0;
  const double fraction = std::frexp(nominalTileWidthMeters(radiusMeters, level, scheme), &exponent);
  return (fraction > 0.5 ? exponent : exponent - 1) - 15;
}

double stepMeters(int stepExponent) noexcept {
  // A normal number's bits, since ldexp is a call that rounding to the lattice would make for each vertex.
  constexpr int kLeast = std::numeric_limits<double>::min_exponent - 1,
                kMost = std::numeric_limits<double>::max_exponent - 1;
  if (stepExponent < kLeast || stepExponent > kMost) return std::ldexp(1.0, stepExponent);
  constexpr int kBias = kMost, kFractionBits = std::numeric_limits<double>::digits - 1;
  return std::bit_cast<double>(static_cast<std::uint64_t>(stepExponent + kBias) << kFractionBits);
}

int maxLevel(double radiusMeters, Scheme scheme) noexcept {
  int level = FacePath::kMaxLevel;
  while (level > 0 && stepExponent(radiusMeters, level, scheme) < kMinStepExponent) --level;
  return level;
}

LatticePoint roundToLattice(const glm::dvec3& positionBody, int stepExponent) noexcept {
  const double stepsPerMeter = stepMeters(-stepExponent);
  return LatticePoint(roundHalfUp(positionBody.x * stepsPerMeter), roundHalfUp(positionBody.y * stepsPerMeter),
                      roundHalfUp(positionBody.z * stepsPerMeter));
}

glm::dvec3 latticePosition(const LatticePoint& point, int stepExponent) noexcept {
  const double step = stepMeters(stepExponent);
  return glm::dvec3(static_cast<double>(point.x) * step, static_cast<double>(point.y) * step,
                    static_cast<double>(point.z) * step);
}

}  // namespace terrane

#include "common/tiling/lattice.h"

#include <bit>
#include <cmath>
#include <limits>

#include "common/numerics/power_of_two.h"
#include "common/tiling/icosahedron.h"

namespace terrane {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

std::int64_t latticeCoordinate(double steps) noexcept { return static_cast<std::int64_t>(roundedHalfUp(steps)); }

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

double stepMeters(int stepExponent) noexcept { return powerOfTwo(stepExponent); }

int maxLevel(double radiusMeters, Scheme scheme) noexcept {
  int level = FacePath::kMaxLevel;
  while (level > 0 && stepExponent(radiusMeters, level, scheme) < kMinStepExponent) --level;
  return level;
}

LatticePoint roundToLattice(const glm::dvec3& positionBody, int stepExponent) noexcept {
  const double stepsPerMeter = stepMeters(-stepExponent);
  return LatticePoint(latticeCoordinate(positionBody.x * stepsPerMeter),
                      latticeCoordinate(positionBody.y * stepsPerMeter),
                      latticeCoordinate(positionBody.z * stepsPerMeter));
}

glm::dvec3 latticePosition(const LatticePoint& point, int stepExponent) noexcept {
  const double step = stepMeters(stepExponent);
  return glm::dvec3(static_cast<double>(point.x) * step, static_cast<double>(point.y) * step,
                    static_cast<double>(point.z) * step);
}

}  // namespace terrane

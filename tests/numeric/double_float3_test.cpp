// Vectors of double-floats against MPFR: lengths, directions and dot products within their stated bounds, from the
// Moon's rim to 30 AU; plain float beside them is not.
#include "common/numerics/double_float3.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>

#include "tests/numeric/double_float_search.h"

namespace terrane {
namespace {

using test::HighPrecision;
using test::Operands;

using HighPrecision3 = std::array<HighPrecision, 3>;

HighPrecision3 exact(const DoubleFloat3& v) {
  HighPrecision3 value;
  for (int axis = 0; axis < 3; ++axis)
    value[static_cast<std::size_t>(axis)] = HighPrecision(v.hi[axis]) + HighPrecision(v.lo[axis]);
  return value;
}
HighPrecision exactDot(const HighPrecision3& a, const HighPrecision3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double units(const HighPrecision& error, const HighPrecision& of) {
  return std::fabs(static_cast<double>(HighPrecision(error / of))) / kFloatUnitSquared;
}

/// Components of one order of magnitude, or of three very different ones.
DoubleFloat3 vector(Operands& operands, int exponent) {
  DoubleFloat3 v;
  const int spread = operands.bits(1) != 0 ? 0 : 12;
  for (int axis = 0; axis < 3; ++axis) {
    const DoubleFloat x = operands.pair(exponent - spread * axis, exponent - spread * axis + 1);
    v.hi[axis] = x.hi;
    v.lo[axis] = x.lo;
  }
  return v;
}

TEST(DoubleFloat3, LengthsDirectionsAndDotProductsStayWithinTheirBounds) {
  Operands operands(351);
  double worstLength = 0, worstDirection = 0, worstDot = 0, control = 0;
  for (int i = 0; i < 60000; ++i) {
    const int exponent = std::array{-10, 0, 21, 42}[operands.bits(2)];  // 1 mm, 1 m, the Moon's radius, 30 AU
    const DoubleFloat3 v = vector(operands, exponent), w = vector(operands, exponent);
    const HighPrecision3 x = exact(v), y = exact(w);
    const HighPrecision norm = sqrt(exactDot(x, x));
    worstLength = std::max(worstLength, units(test::exact(length(v)) - norm, norm));
    const HighPrecision3 direction = exact(normalize(v));
    for (std::size_t axis = 0; axis < 3; ++axis)
      worstDirection = std::max(worstDirection, units(direction[axis] - x[axis] / norm, x[axis] / norm));
    const HighPrecision sizes = abs(x[0] * y[0]) + abs(x[1] * y[1]) + abs(x[2] * y[2]);
    worstDot = std::max(worstDot, units(test::exact(dot(v, w)) - exactDot(x, y), sizes));
    control = std::max(control, units(HighPrecision(glm::length(v.hi)) - norm, norm));
  }
  std::cout << "length: worst " << worstLength << " u^2, bound " << kLengthBound << "; direction: " << worstDirection
            << " u^2, bound " << kNormalizeBound << "; dot product: " << worstDot << " u^2 of its terms, bound "
            << kDotBound << "; control, float's length: " << control << " u^2\n";
  EXPECT_EQ(length(DoubleFloat3()).hi, 0.0f);
  EXPECT_LE(worstLength, kLengthBound);
  EXPECT_LE(worstDirection, kNormalizeBound);
  EXPECT_LE(worstDot, kDotBound);
  EXPECT_GT(worstLength, 0.3 * kLengthBound) << "the search is too easy to prove anything";
  EXPECT_GT(worstDirection, 0.25 * kNormalizeBound);
  EXPECT_GT(control, 1e6);
}

TEST(DoubleFloat3, ADirectionTimesTheMoonsRadiusIsWithinAFifthOfAMicrometreOfTheSphere) {
  Operands operands(352);
  constexpr double kRadiusMeters = 1737400.0;
  double worstMeters = 0, control = 0;
  for (int i = 0; i < 20000; ++i) {
    const DoubleFloat3 v = vector(operands, 0);
    const HighPrecision3 x = exact(v), placed = exact(multiply(normalize(v), fromDouble(kRadiusMeters)));
    const HighPrecision norm = sqrt(exactDot(x, x));
    const glm::vec3 plain = glm::normalize(v.hi) * static_cast<float>(kRadiusMeters);
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const HighPrecision at = x[a] / norm * kRadiusMeters;
      worstMeters = std::max(worstMeters, std::fabs(static_cast<double>(HighPrecision(placed[a] - at))));
      control = std::max(control, std::fabs(static_cast<double>(HighPrecision(HighPrecision(plain[axis]) - at))));
    }
  }
  std::cout << "off by at most " << worstMeters << " m; control, float: " << control << " m\n";
  // The direction's bound and the last product's, of the radius.
  EXPECT_LE(worstMeters, (kNormalizeBound + kMultiplyBound) * kFloatUnitSquared * kRadiusMeters * 1.001);
  EXPECT_LE(worstMeters, 2e-7);
  EXPECT_GT(control, 0.05);
}

}  // namespace
}  // namespace terrane

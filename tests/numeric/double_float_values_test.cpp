// Double-floats as numbers: what becomes of a double, their order, and what they are for: positions near a camera far
// from the origin.
#include "common/numerics/double_float.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <iostream>

#include "tests/numeric/double_float_search.h"

namespace terrane {
namespace {

using test::exact;
using test::HighPrecision;
using test::isNormalised;
using test::kSamples;
using test::Limits;
using test::Operands;

TEST(DoubleFloat, ADoubleAtOneAstronomicalUnitComesBackWithinAQuarterMillimetre) {
  Operands operands(321);
  constexpr double kAstronomicalUnitMeters = 149597870700.0;
  double worst = 0, control = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double d = kAstronomicalUnitMeters * (0.5 + static_cast<double>(operands.bits(53)) * 0x1p-54);
    const DoubleFloat x = fromDouble(d);
    ASSERT_TRUE(isNormalised(x));
    worst = std::max(worst, std::fabs(toDouble(x) - d));
    control = std::max(control, std::fabs(static_cast<double>(static_cast<float>(d)) - d));
    ASSERT_LE(std::fabs(toDouble(x) - d), kFromDoubleBound * kFloatUnitSquared * d);
  }
  std::cout << "worst " << worst << " m; control, float: " << control << " m\n";
  EXPECT_LE(worst, 2.5e-4);
  EXPECT_GT(control, 1000.0);
}

TEST(DoubleFloat, LatticePositionsAreExact) {
  // Tile origins are multiples of a power of two with at most 45 bits: nothing is lost.
  Operands operands(322);
  for (int i = 0; i < kSamples; ++i) {
    const double origin = std::ldexp(static_cast<double>(operands.bits(45)), -23) * (operands.bits(1) ? 1 : -1);
    ASSERT_EQ(toDouble(fromDouble(origin)), origin);
  }
}

TEST(DoubleFloat, ComparisonIsByValue) {
  Operands operands(323);
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(-1, 1);
    const DoubleFloat y = i % 3 == 0 ? x : i % 3 == 1 ? twoSum(x.hi, operands.single(-40, -26)) : operands.pair(-1, 1);
    const HighPrecision difference = exact(x) - exact(y);
    const std::partial_ordering order = compare(x, y);
    ASSERT_EQ(order == std::partial_ordering::less, difference < 0);
    ASSERT_EQ(order == std::partial_ordering::greater, difference > 0);
    ASSERT_EQ(order == std::partial_ordering::equivalent, difference == 0);
  }
  EXPECT_EQ(compare(fromDouble(0.0), fromDouble(-0.0)), std::partial_ordering::equivalent);
  EXPECT_EQ(compare(DoubleFloat{Limits::quiet_NaN(), 0}, fromDouble(1)), std::partial_ordering::unordered);
}

TEST(DoubleFloat, ACameraMovedByAMillimetreMovesEveryVertexByAMillimetre) {
  // Vertices within 8 m of a camera at the Earth's radius; the camera steps 1 mm along x. What the vertex shader does:
  // origin plus offset, minus camera, demoted to float.
  Operands operands(331);
  constexpr double kRadiusMeters = 6371000.0;
  constexpr double kMillimetre = 1e-3;
  double worst = 0, control = 0;
  for (int i = 0; i < 20000; ++i) {
    const double angle = static_cast<double>(operands.bits(53)) * 0x1p-53;
    const double camera = kRadiusMeters * angle;
    const double vertex =
        std::floor((camera + 16.0 * (static_cast<double>(operands.bits(53)) * 0x1p-53 - 0.5)) * 1024.0) / 1024.0;
    const DoubleFloat position = fromDouble(vertex);
    const float before = subtractAndDemote(position, fromDouble(camera));
    const float after = subtractAndDemote(position, fromDouble(camera + kMillimetre));
    worst = std::max(worst, std::fabs(static_cast<double>(before) - static_cast<double>(after) - kMillimetre));
    const float floatBefore = static_cast<float>(vertex) - static_cast<float>(camera);
    const float floatAfter = static_cast<float>(vertex) - static_cast<float>(camera + kMillimetre);
    control =
        std::max(control, std::fabs(static_cast<double>(floatBefore) - static_cast<double>(floatAfter) - kMillimetre));
  }
  std::cout << "off by at most " << worst << " m; control, float: " << control << " m\n";
  // A float of 50 m has a spacing of 3.8 micrometres: half of that, twice, is the float's own; the rest must be
  // nothing.
  EXPECT_LE(worst, 1e-6);
  EXPECT_GT(control, 0.1);
}

}  // namespace
}  // namespace terrane

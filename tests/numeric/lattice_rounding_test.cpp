// Rounding to the lattice: the nearest point, the same way on both sides of 0.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "common/tiling/lattice.h"
#include "tests/numeric/samples.h"

namespace terrane {
namespace {

std::int64_t rounded(double x) { return roundToLattice(glm::dvec3(x, 0, 0), 0).x; }

TEST(LatticeRounding, GoesToTheNearestPointWithHalvesUpAndNegativesDown) {
  EXPECT_EQ(rounded(0.0), 0);
  EXPECT_EQ(rounded(-0.0), 0);
  EXPECT_EQ(rounded(0.5), 1);
  EXPECT_EQ(rounded(-0.5), 0);
  EXPECT_EQ(rounded(-0.75), -1);
  EXPECT_EQ(rounded(-1.5), -1);
  EXPECT_EQ(rounded(-1.25), -1);
  EXPECT_EQ(rounded(2.5), 3);
  EXPECT_EQ(rounded(-1e-300), 0);
  EXPECT_EQ(rounded(std::nextafter(-0.5, -1.0)), -1);
  EXPECT_EQ(rounded(std::nextafter(-0.5, 0.0)), 0);
  EXPECT_EQ(rounded(std::nextafter(0.5, 0.0)), 0);
  // The usual floor(x + 0.5) fails there: the sum rounds to 1.
  EXPECT_EQ(std::floor(std::nextafter(0.5, 0.0) + 0.5), 1.0);
  const double large = std::ldexp(1.0, 50) + 0.5;
  EXPECT_EQ(rounded(large), (std::int64_t{1} << 50) + 1);
  EXPECT_EQ(rounded(-large), -(std::int64_t{1} << 50));
}

/// By an integer and comparisons alone.
double roundedByInteger(double x) {
  const auto towardsZero = static_cast<std::int64_t>(x);
  const std::int64_t lower = towardsZero - (static_cast<double>(towardsZero) > x ? 1 : 0);
  return static_cast<double>(lower + (x - static_cast<double>(lower) >= 0.5 ? 1 : 0));
}

TEST(LatticeRounding, WithoutAnIntegerIsTheSameUpToItsLimit) {
  std::mt19937_64 random = test::seededRandom(52);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto expectSame = [](double x) {
    for (const double near : {std::nextafter(x, -1e300), x, std::nextafter(x, 1e300)})
      ASSERT_EQ(roundedHalfUp(near), roundedByInteger(near)) << near;
  };
  for (int exponent = -60; exponent <= 51; ++exponent) {
    const double scale = std::nextafter(std::ldexp(1.0, exponent), 0.0);
    for (int i = 0; i < 2000; ++i) {
      const double x = unit(random) * std::nextafter(scale, 0.0), whole = std::trunc(x);
      for (const double y : {x, whole, whole + 0.5, whole - 0.5})
        if (std::abs(y) < scale || exponent < 51) expectSame(y);
    }
  }
}

/// The control: the usual cast, which cuts towards 0.
std::int64_t truncated(double x) { return static_cast<std::int64_t>(x + 0.5); }

/// How many of the places x = k / 64 in [-8.5, 8.5) each lattice point from -8 to 8 collects.
std::vector<int> placesPerPoint(std::int64_t (*toPoint)(double)) {
  std::vector<int> places(19);
  for (int k = -8 * 64 - 32; k < 8 * 64 + 32; ++k) ++places[static_cast<std::size_t>(toPoint(k / 64.0) + 9)];
  return std::vector<int>(places.begin() + 1, places.end() - 1);
}

TEST(LatticeRounding, GivesEveryPointTheSameShareOfTheLineOnBothSidesOfZero) {
  const std::vector<int> places = placesPerPoint(rounded);
  EXPECT_EQ(places, std::vector<int>(17, 64));
  const std::vector<int> control = placesPerPoint(truncated);
  EXPECT_GT(control[8], 64) << "the control folds the line at 0: its point there has more than its share";
}

TEST(LatticeRounding, MovesAlongWithThePositionAcrossZero) {
  std::mt19937_64 random = test::seededRandom(51);
  int moved = 0, cases = 0;
  for (int i = 0; i < 20000; ++i) {
    // 32 + 8 bits: the sums are exact.
    const double x = static_cast<double>(static_cast<std::int64_t>(random() >> 32) - (std::int64_t{1} << 31)) / 256.0;
    const auto steps = static_cast<std::int64_t>(random() >> 34) - (std::int64_t{1} << 29);
    ASSERT_EQ(rounded(x + static_cast<double>(steps)), rounded(x) + steps) << x << " + " << steps;
    ++cases;
    moved += truncated(x + static_cast<double>(steps)) != truncated(x) + steps;
  }
  std::cout << "control, truncation: " << moved << " of " << cases << " points move otherwise\n";
  EXPECT_GT(moved, cases / 4);
}

TEST(LatticeRounding, MovesByHalfAStepAtMostAndLatticePointsStay) {
  std::mt19937_64 random = test::seededRandom(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worstControl = 0;
  for (double radius = kMinRadiusMeters; radius <= kMaxRadiusMeters; radius *= 1.37) {
    for (const int level : {0, 7, 18, 30}) {
      const int exponent = stepExponent(radius, level);
      const double step = stepMeters(exponent);
      for (int i = 0; i < 50; ++i) {
        const glm::dvec3 p(unit(random) * radius, unit(random) * radius, unit(random) * radius);
        const LatticePoint q = roundToLattice(p, exponent);
        const glm::dvec3 back = latticePosition(q, exponent);
        for (int k = 0; k < 3; ++k) {
          ASSERT_LE(std::fabs(back[k] - p[k]), 0.5 * step);
          worstControl =
              std::max(worstControl, std::fabs(static_cast<double>(truncated(p[k] / step)) * step - p[k]) / step);
        }
        ASSERT_EQ(roundToLattice(back, exponent), q);
      }
    }
  }
  EXPECT_GT(worstControl, 0.9) << "in steps; the control, truncation, is off by nearly two halves";
}

}  // namespace
}  // namespace terrane

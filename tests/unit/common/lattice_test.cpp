#include "common/tiling/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "common/tiling/cube_sphere.h"

namespace terrane {
namespace {

std::vector<double> bodyRadii() {
  std::vector<double> radii{kMinRadiusMeters, 1737400.0, 3389500.0, 6371000.0, 6378137.0, 69911000.0, kMaxRadiusMeters};
  for (double radius = kMinRadiusMeters; radius < kMaxRadiusMeters; radius *= 1.37) radii.push_back(radius);
  return radii;
}

TEST(Lattice, StepIsTheSmallestPowerOfTwoThatSpansATileIn32768) {
  for (const double radius : bodyRadii()) {
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      const double step = stepMeters(stepExponent(radius, level));
      const double width = nominalTileWidthMeters(radius, level);
      ASSERT_GE(step * 32768.0, width);
      ASSERT_LT(step * 16384.0, width);
    }
  }
  // A width that is a power of two itself takes the step without rounding up; one ulp more takes the next.
  double radius = 1048576.0 / 1.5707963267948966;
  ASSERT_EQ(nominalTileWidthMeters(radius, 0), 1048576.0);
  while (nominalTileWidthMeters(std::nextafter(radius, 1e9), 0) == 1048576.0) radius = std::nextafter(radius, 1e9);
  EXPECT_EQ(stepExponent(radius, 0), 5);
  EXPECT_EQ(stepExponent(std::nextafter(radius, 1e9), 0), 6);
}

TEST(Lattice, AParentsStepIsTwiceItsChilds) {
  for (const double radius : bodyRadii()) {
    for (int level = 1; level <= FacePath::kMaxLevel; ++level) {
      ASSERT_EQ(stepExponent(radius, level - 1), stepExponent(radius, level) + 1);
    }
  }
}

TEST(Lattice, TheLevelCapIsTheFinestWithAStepAClientCanShade) {
  for (const double radius : bodyRadii()) {
    const int level = maxLevel(radius);
    ASSERT_GE(stepExponent(radius, level), kMinStepExponent) << radius;
    if (level < FacePath::kMaxLevel) {
      ASSERT_LT(stepExponent(radius, level + 1), kMinStepExponent) << radius;
    }
  }
  EXPECT_EQ(maxLevel(kMaxRadiusMeters), 30);
  EXPECT_GT(maxLevel(kMinRadiusMeters), 10);
}

TEST(Lattice, PositionsNeedAtMost45Bits) {
  for (const double radius : bodyRadii()) {
    const double step = stepMeters(stepExponent(radius, FacePath::kMaxLevel));
    // Half as high again as the radius still fits.
    ASSERT_LE(1.5 * radius / step, std::ldexp(1.0, 45)) << radius;
    ASSERT_LE(radius / step, std::exp2(44.4)) << radius;
  }
}

/// The largest extent of a tile's corners and edge midpoints along a body axis, in steps. Its edges bulge by less than
/// a cell.
double footprintExtentSteps(const FacePath& path, double radius) {
  glm::dvec3 low(1e300), high(-1e300);
  const int grid = 4;
  for (std::uint64_t j = 0; j <= (1u << grid); ++j) {
    for (std::uint64_t i = 0; i <= (1u << grid); ++i) {
      const glm::dvec3 d =
          cubeGridDirection(path.face(), path.level() + grid, (std::uint64_t{path.column()} << grid) + i,
                            (std::uint64_t{path.row()} << grid) + j);
      for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], d[k] * radius);
        high[k] = std::max(high[k], d[k] * radius);
      }
    }
  }
  const glm::dvec3 extent = high - low;
  return std::max(extent.x, std::max(extent.y, extent.z)) / stepMeters(stepExponent(radius, path.level()));
}

TEST(Lattice, SixteenBitsHoldEveryTilesFootprint) {
  const std::uint64_t seed = 31;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  double worst = 0;
  std::string where;
  for (const double radius : bodyRadii()) {
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      // The widest tiles are at a face's centre; 12 others at random.
      for (int i = 0; i < 14; ++i) {
        const std::uint32_t middle = level ? 1u << (level - 1) : 0u;
        const std::uint32_t mask = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
        const int face = i < 2 ? 4 * i : static_cast<int>(random() % 6);
        const std::uint32_t column = i < 2 ? middle : static_cast<std::uint32_t>(random()) & mask;
        const std::uint32_t row = i < 2 ? middle : static_cast<std::uint32_t>(random()) & mask;
        const FacePath path = FacePath::cubeTile(face, level, column, row);
        const double extent = footprintExtentSteps(path, radius);
        if (extent > worst) {
          worst = extent;
          where = path.text() + " of a body of " + std::to_string(radius) + " m";
        }
      }
    }
  }
  std::cout << "widest footprint " << worst << " of " << kTileOffsetMax << " steps: " << where << '\n';
  // The diagonal of the widest tile, sqrt(2) 2^15, could lie along an axis: 46341 steps. What is above is left to
  // heights.
  EXPECT_LE(worst, 46341.0);
  EXPECT_GT(worst, 30000.0);
}

TEST(Lattice, RoundsToTheNearestPointWithHalvesUpAndNegativesDown) {
  const auto rounded = [](double x) { return roundToLattice(glm::dvec3(x, 0, 0), 0).x; };
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

TEST(Lattice, RoundingMovesByHalfAStepAtMostAndLatticePointsStay) {
  const std::uint64_t seed = 5;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const double radius : bodyRadii()) {
    for (const int level : {0, 7, 18, 30}) {
      const int exponent = stepExponent(radius, level);
      for (int i = 0; i < 50; ++i) {
        const glm::dvec3 p(unit(random) * radius, unit(random) * radius, unit(random) * radius);
        const LatticePoint q = roundToLattice(p, exponent);
        const glm::dvec3 back = latticePosition(q, exponent);
        for (int k = 0; k < 3; ++k) ASSERT_LE(std::fabs(back[k] - p[k]), 0.5 * stepMeters(exponent));
        ASSERT_EQ(roundToLattice(back, exponent), q);
      }
    }
  }
}

TEST(Lattice, TheMidpointOfTwoParentVerticesIsAPointOfTheChildsLattice) {
  const std::uint64_t seed = 6;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  const double radius = 1737400.0;
  for (int i = 0; i < 2000; ++i) {
    const int level = static_cast<int>(random() % 30);
    const std::uint64_t cells = std::uint64_t{1} << (level + 6);
    const std::uint64_t column = random() % cells;
    const std::uint64_t row = random() % cells;
    const int face = static_cast<int>(random() % 6);
    const int parent = stepExponent(radius, level);
    const glm::dvec3 a =
        latticePosition(roundToLattice(cubeGridDirection(face, level + 6, column, row) * radius, parent), parent);
    const glm::dvec3 b =
        latticePosition(roundToLattice(cubeGridDirection(face, level + 6, column + 1, row) * radius, parent), parent);
    const glm::dvec3 middle = (a + b) * 0.5;
    const int child = stepExponent(radius, level + 1);
    ASSERT_EQ(latticePosition(roundToLattice(middle, child), child), middle);
  }
}

}  // namespace
}  // namespace terrane

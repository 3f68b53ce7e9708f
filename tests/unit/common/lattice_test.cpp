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

}  // namespace
}  // namespace terrane

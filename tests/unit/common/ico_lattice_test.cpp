// The lattice of the `ico` scheme: its step, and that a tile's offsets fit 16 bits.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

/// 250 m to the Sun, and radii at which a level's tiles are just below and above a power of two wide: there the step is
/// coarsest and finest for them.
std::vector<double> bodyRadii() {
  std::vector<double> radii{kMinRadiusMeters, 1e3, 1737400.0, 6371000.0, 69911000.0, 1e8, kMaxRadiusMeters};
  for (double radius = 1e3; radius <= 1e8; radius *= 3.7) radii.push_back(radius);
  for (const double power : {0x1p10, 0x1p22, 0x1p26})
    for (const double beside : {0.999999, 1.000001}) radii.push_back(beside * power / kIcosahedronEdgeAngle);
  return radii;
}

TEST(IcoLattice, StepIsTheSmallestPowerOfTwoThatSpansATileIn32768) {
  for (const double radius : bodyRadii()) {
    EXPECT_EQ(nominalTileWidthMeters(radius, 0, Scheme::Ico), std::atan(2.0) * radius);
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      const double step = stepMeters(stepExponent(radius, level, Scheme::Ico));
      const double width = nominalTileWidthMeters(radius, level, Scheme::Ico);
      ASSERT_GE(step * 32768.0, width) << radius << " m, level " << level;
      ASSERT_LT(step * 16384.0, width) << radius << " m, level " << level;
      if (level > 0) {
        ASSERT_EQ(stepExponent(radius, level - 1, Scheme::Ico), stepExponent(radius, level, Scheme::Ico) + 1);
      }
    }
    const int finest = maxLevel(radius, Scheme::Ico);
    ASSERT_GE(stepExponent(radius, finest, Scheme::Ico), kMinStepExponent);
    if (finest < FacePath::kMaxLevel) {
      ASSERT_LT(stepExponent(radius, finest + 1, Scheme::Ico), kMinStepExponent);
    }
  }
}

/// The largest extent along a body axis, in steps, of any mesh over the tile whose heights are within +-height. Offsets
/// count from a lattice point at or below the lowest vertex, so there are up to two steps of rounding more.
double meshExtentSteps(IcoMap map, const FacePath& path, double radius, double height) {
  const int cells = 8;
  const auto size = static_cast<std::size_t>(triangleGridSize(cells));
  std::vector<double> x(size), y(size), z(size);
  icoGridDirections(map, path, cells, {x, y, z});
  double extent = 0;
  for (const std::vector<double>* along : {&x, &y, &z}) {
    double low = 1e300, high = -1e300;
    for (const double c : *along) {
      low = std::min({low, c * (radius - height), c * (radius + height)});
      high = std::max({high, c * (radius - height), c * (radius + height)});
    }
    extent = std::max(extent, high - low);
  }
  return extent / stepMeters(stepExponent(radius, path.level(), Scheme::Ico)) + 2;
}

/// Tiles of a level: of bisection's widest, at the middle of the face; its corners; and any.
std::vector<FacePath> tilesOf(std::mt19937_64& random, int level) {
  std::vector<FacePath> tiles;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (const int digit : {3, face % 3}) {
      FacePath path = FacePath::wholeFace(Scheme::Ico, face);
      while (path.level() < level) path = path.child(digit);
      tiles.push_back(path);
    }
    tiles.push_back(test::randomIcoTile(random, level));
  }
  return tiles;
}

struct Widest {
  double steps = 0;
  std::string where;
  void consider(double extent, const FacePath& path, double radius) {
    if (extent <= steps) return;
    steps = extent;
    where = path.text() + " of a body of " + std::to_string(radius) + " m";
  }
};

TEST(IcoLattice, SixteenBitsHoldEveryTilesMesh) {
  const std::uint64_t seed = 621;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  Widest bare, coarse, fine, control;
  for (const double radius : bodyRadii()) {
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      const double width = nominalTileWidthMeters(radius, level, Scheme::Ico);
      for (const FacePath& path : tilesOf(random, level)) {
        for (const IcoMap map : {IcoMap::Bisected, IcoMap::Gnomonic}) {
          bare.consider(meshExtentSteps(map, path, radius, 0), path, radius);
          // Relief of 1 % of the radius as long as that is no cliff over a whole tile; then 60 % of its width.
          Widest& widest = level <= 6 ? coarse : fine;
          widest.consider(meshExtentSteps(map, path, radius, level <= 6 ? 0.01 * radius : 0.6 * width), path, radius);
          if (level == 8) control.consider(meshExtentSteps(map, path, radius, 0.01 * radius), path, radius);
        }
      }
    }
  }
  std::cout << "widest of " << kTileOffsetMax << " steps: without heights " << bare.steps << ", " << bare.where
            << "; +-1 % of the radius to level 6 " << coarse.steps << ", " << coarse.where
            << "; +-60 % of a tile's width below " << fine.steps << ", " << fine.where << "; control, +-1 % at level 8 "
            << control.steps << '\n';
  EXPECT_LE(bare.steps, 1.2 * 32768 + 2);
  EXPECT_GT(bare.steps, 30000.0);
  EXPECT_LE(coarse.steps, kTileOffsetMax);
  EXPECT_LE(fine.steps, kTileOffsetMax);
  EXPECT_GT(control.steps, kTileOffsetMax);
}

}  // namespace
}  // namespace terrane

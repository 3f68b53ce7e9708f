// What lets a child's edge become exactly its parent's: both levels sample the same directions where they share a
// vertex, and what lies on or halfway between points of the parent's lattice lies on the child's.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "server/build/grid_directions.h"
#include "tests/numeric/samples.h"

namespace terrane {
namespace {

constexpr double kMoonRadius = 1'737'400.0;
constexpr int kCells = 64, kCellLevels = 6;
constexpr std::size_t kSide = kCells + 1;

FacePath randomTile(std::mt19937_64& random, int level) {
  const std::uint64_t mask = (std::uint64_t{1} << level) - 1;
  const auto column = static_cast<std::uint32_t>(random() % 4 == 0 ? mask : random() & mask);
  const auto row = static_cast<std::uint32_t>(random() & mask);
  return FacePath::cubeTile(static_cast<int>(random() % 6), level, column, row);
}

glm::dvec3 directionAt(const GridDirections& grid, std::size_t i, std::size_t j) {
  const std::size_t at = j * kSide + i;
  return {grid.x[at], grid.y[at], grid.z[at]};
}

TEST(ParentAndChild, AParentsStepIsTwiceItsChilds) {
  for (double radius = kMinRadiusMeters; radius <= kMaxRadiusMeters; radius *= 1.0137) {
    for (int level = 1; level <= FacePath::kMaxLevel; ++level)
      ASSERT_EQ(stepExponent(radius, level - 1), stepExponent(radius, level) + 1) << radius;
  }
}

/// The control: a grid line's angle counted from the tile's own corner, in radians.
double angleFromCorner(int level, std::uint32_t column, std::size_t line) {
  const double width = std::ldexp(0.5 * std::numbers::pi, -level);
  return (-0.25 * std::numbers::pi + column * width) + static_cast<double>(line) * (width / kCells);
}

TEST(ParentAndChild, EvenVerticesOfAChildHaveTheParentsDirectionsToTheBit) {
  std::mt19937_64 random = test::seededRandom(44);
  GridDirections ofParent, ofChild;
  std::size_t compared = 0, lines = 0, linesApart = 0;
  for (int round = 0; round < 200; ++round) {
    const FacePath parent = randomTile(random, round % FacePath::kMaxLevel);
    const int digit = static_cast<int>(random() % 4);
    const FacePath child = parent.child(digit);
    gridDirections(parent, kCells, ofParent);
    gridDirections(child, kCells, ofChild);
    const std::size_t firstColumn = (digit & 1) != 0 ? kCells / 2 : 0, firstRow = (digit & 2) != 0 ? kCells / 2 : 0;
    for (std::size_t i = 0; i < kSide; i += 2) {
      for (std::size_t j = 0; j < kSide; j += 2, ++compared) {
        ASSERT_TRUE(
            test::sameBits(directionAt(ofChild, i, j), directionAt(ofParent, firstColumn + i / 2, firstRow + j / 2)))
            << parent.text() << " child " << digit << " vertex " << i << ' ' << j;
      }
      ++lines;
      linesApart += angleFromCorner(parent.level(), parent.column(), firstColumn + i / 2) !=
                    angleFromCorner(child.level(), child.column(), i);
    }
  }
  std::cout << compared << " vertices equal; control, angles from the tile's corner: " << linesApart << " of " << lines
            << " lines apart\n";
  EXPECT_GT(linesApart, lines / 10);
}

/// Positions of two neighbouring vertices of a parent's grid, rounded to its lattice.
struct ParentEdge {
  int level;
  glm::dvec3 a, b;
};
ParentEdge randomEdge(std::mt19937_64& random, double radiusMeters) {
  const int level = static_cast<int>(random() % FacePath::kMaxLevel);
  const std::uint64_t cells = std::uint64_t{1} << (level + kCellLevels);
  const std::uint64_t column = random() % cells, row = random() % (cells + 1);
  const int face = static_cast<int>(random() % 6), exponent = stepExponent(radiusMeters, level);
  const auto vertex = [&](std::uint64_t at) {
    const glm::dvec3 d = cubeGridDirection(face, level + kCellLevels, at, row);
    return latticePosition(roundToLattice(d * radiusMeters, exponent), exponent);
  };
  return {level, vertex(column), vertex(column + 1)};
}

TEST(ParentAndChild, WhatTheParentHasAndTheMidpointsBetweenLieOnTheChildsLattice) {
  std::mt19937_64 random = test::seededRandom(6);
  int offControl = 0, cases = 0;
  for (const double radius : {kMinRadiusMeters, kMoonRadius, 6'371'000.0, kMaxRadiusMeters}) {
    for (int i = 0; i < 2000; ++i, ++cases) {
      const ParentEdge edge = randomEdge(random, radius);
      const glm::dvec3 middle = (edge.a + edge.b) * 0.5;
      const int child = stepExponent(radius, edge.level + 1);
      for (const glm::dvec3& p : {edge.a, edge.b, middle})
        ASSERT_TRUE(test::sameBits(latticePosition(roundToLattice(p, child), child), p + glm::dvec3(0.0)));
      // The control: a step that fits the child's width and is no power of two.
      const double step = nominalTileWidthMeters(radius, edge.level + 1) / 32768.0;
      offControl += std::round(middle.x / step) * step != middle.x;
    }
  }
  std::cout << "control, steps that fit the width: " << offControl << " of " << cases << " midpoints off\n";
  EXPECT_GT(offControl, cases / 2);
}

}  // namespace
}  // namespace terrane

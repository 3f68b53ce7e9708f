#include "common/tiling/triangle_tile.h"

#include <gtest/gtest.h>

#include <array>
#include <iostream>
#include <random>
#include <set>
#include <vector>

#include "tests/support/ico_points.h"

namespace terrane {
namespace {

using test::allIcoTiles;
using test::randomIcoTile;
using Corners = std::array<FaceWeights, kTriangleCorners>;

std::mt19937_64 seeded(std::uint64_t seed) {
  std::cout << "seed " << seed << '\n';
  return std::mt19937_64(seed);
}

Corners cornersOf(const FacePath& path) { return tileCorners(triangleTile(path)); }

/// The rule of triangle_tile.h with nothing but corners, in units of 2^-level of the deepest level: all divisions
/// exact.
Corners cornersByMidpoints(const FacePath& path) {
  const std::int64_t whole = std::int64_t{1} << path.level();
  Corners corners{FaceWeights(whole, 0, 0), FaceWeights(0, whole, 0), FaceWeights(0, 0, whole)};
  for (int i = 0; i < path.level(); ++i) {
    const Corners parent = corners;
    const auto digit = static_cast<std::size_t>(path.digit(i));
    for (std::size_t k = 0; k < 3; ++k) {
      const bool centre = digit == 3;
      corners[k] = (centre ? parent[(k + 1) % 3] + parent[(k + 2) % 3] : parent[digit] + parent[k]) / std::int64_t{2};
    }
  }
  return corners;
}

/// Twice the signed area on the face, in cells: positive if counter-clockwise.
std::int64_t area(const Corners& c) {
  const FaceWeights p = c[1] - c[0], q = c[2] - c[0];
  return p.y * q.z - p.z * q.y;
}

TEST(TriangleTile, CornersAreWhatBisectingTheFaceComesTo) {
  std::mt19937_64 random = seeded(601);
  std::vector<FacePath> tiles;
  for (int level = 0; level <= 4; ++level) {
    for (const FacePath& path : allIcoTiles(level)) tiles.push_back(path);
  }
  for (int i = 0; i < 20000; ++i) tiles.push_back(randomIcoTile(random, i % 31));
  for (const FacePath& path : tiles) {
    const Corners corners = cornersOf(path);
    ASSERT_EQ(corners, cornersByMidpoints(path)) << path.text();
    ASSERT_EQ(area(corners), 1) << path.text() << ": counter-clockwise, and one tile's area";
    for (const FaceWeights& corner : corners)
      ASSERT_EQ(corner.x + corner.y + corner.z, std::int64_t{1} << path.level());
    int threes = 0;
    for (int i = 0; i < path.level(); ++i) threes += path.digit(i) == 3;
    ASSERT_EQ(triangleTile(path).sign, threes % 2 == 0 ? 1 : -1) << path.text();
  }
}

TEST(TriangleTile, PathsFollowFromTilesAndTheirCorners) {
  std::mt19937_64 random = seeded(602);
  for (int i = 0; i < 20000; ++i) {
    const FacePath path = randomIcoTile(random, i % 31);
    const TriangleTile tile = triangleTile(path);
    ASSERT_EQ(pathOf(tile), path) << path.text();
    ASSERT_EQ(tileWithCorners(path.face(), path.level(), tileCorners(tile)), tile) << path.text();
    ASSERT_EQ(FacePath::fromPackedDigits(Scheme::Ico, path.face(), path.level(), path.packedDigits()), path);
  }
}

TEST(TriangleTile, CornersThatAreNoTilesAreRefused) {
  const Corners upright = cornersOf(FacePath::parse("ico/3/012").value());
  EXPECT_TRUE(tileWithCorners(3, 3, upright).has_value());
  EXPECT_FALSE(tileWithCorners(3, 2, upright).has_value()) << "of another level";
  EXPECT_FALSE(tileWithCorners(3, 3, Corners{upright[1], upright[2], upright[0]}).has_value()) << "in another order";
  EXPECT_FALSE(tileWithCorners(3, 3, Corners{upright[0], upright[2], upright[1]}).has_value()) << "clockwise";
  EXPECT_FALSE(tileWithCorners(3, 3, Corners{upright[0], upright[0], upright[0]}).has_value());
  const FaceWeights beyond(9, -1, 0);
  EXPECT_FALSE(tileWithCorners(3, 3, Corners{beyond, upright[1], upright[2]}).has_value()) << "off the face";
}

TEST(TriangleTile, GridVerticesHaveExactWeightsToLevelThirtyAndFallBackToTheirPlace) {
  std::mt19937_64 random = seeded(603);
  const int cells = 64;
  for (int i = 0; i < 20000; ++i) {
    const FacePath path = randomIcoTile(random, i % 31);
    const TriangleTile tile = triangleTile(path);
    const GridVertex vertex{static_cast<int>(random() % 65), 0};
    const GridVertex inside{vertex.i, static_cast<int>(random() % static_cast<unsigned>(65 - vertex.i))};
    const FaceWeights weights = gridVertexWeights(tile, cells, inside);
    // corner 0 + i / 64 of the way to corner 1 + j / 64 of the way to corner 2
    const Corners corners = tileCorners(tile);
    ASSERT_EQ(weights, corners[0] * std::int64_t{64 - inside.i - inside.j} + corners[1] * std::int64_t{inside.i} +
                           corners[2] * std::int64_t{inside.j});
    ASSERT_EQ(weights.x + weights.y + weights.z, std::int64_t{1} << (path.level() + 6));
    ASSERT_EQ(gridVertexAt(tile, cells, weights), inside);
  }
  const TriangleTile tile = triangleTile(FacePath::parse("ico/3/03").value());
  EXPECT_FALSE(gridVertexAt(tile, cells, FaceWeights(256, 0, 0)).has_value()) << "the face's corner is not the tile's";
  EXPECT_FALSE(gridVertexAt(tile, cells, FaceWeights(1, 2, 3)).has_value()) << "of another grid level";
}

TEST(TriangleTile, TilesOfALevelCoverTheirFaceOnce) {
  // Each vertex of the face's grid of level 4 in its interior belongs to six tiles, on an edge to three, at a corner
  // to one.
  const int level = 4;
  std::map<std::array<std::int64_t, 3>, int> tilesAt;
  for (const FacePath& path : allIcoTiles(level)) {
    if (path.face() != 7) continue;
    for (const FaceWeights& corner : cornersOf(path)) ++tilesAt[{corner.x, corner.y, corner.z}];
  }
  EXPECT_EQ(tilesAt.size(), static_cast<std::size_t>(triangleGridSize(16)));
  for (const auto& [at, count] : tilesAt) {
    const auto zeros = std::count(at.begin(), at.end(), 0);
    EXPECT_EQ(count, zeros == 0 ? 6 : zeros == 1 ? 3 : 1);
  }
}

TEST(TriangleGrid, IndicesCountVerticesRowByRow) {
  for (const int cells : {1, 2, 8, 64}) {
    int next = 0;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i + j <= cells; ++i) ASSERT_EQ(triangleGridIndex(cells, {i, j}), next++);
    }
    EXPECT_EQ(next, triangleGridSize(cells));
  }
  EXPECT_EQ(triangleGridSize(64), 2145);
}

TEST(TriangleGrid, AChildsVertexLiesAtOrInTheMiddleBetweenNeighboursOfTheParentsGrid) {
  std::mt19937_64 random = seeded(604);
  for (const int cells : {2, 8, 64}) {
    for (int round = 0; round < 20; ++round) {
      const FacePath parent = randomIcoTile(random, round);
      for (int digit = 0; digit < 4; ++digit) {
        const TriangleTile above = triangleTile(parent), child = triangleTile(parent.child(digit));
        for (int j = 0; j <= cells; ++j) {
          for (int i = 0; i + j <= cells; ++i) {
            const auto [first, second] = parentGridVertices(digit, cells, {i, j});
            const FaceWeights a = gridVertexWeights(above, cells, first);
            const FaceWeights b = gridVertexWeights(above, cells, second);
            ASSERT_EQ(a + b, gridVertexWeights(child, cells, {i, j})) << parent.text() << ' ' << digit;
            ASSERT_TRUE(gridVertexAt(above, cells, a).has_value() && gridVertexAt(above, cells, b).has_value());
            const FaceWeights apart = a - b;
            const bool even = i % 2 == 0 && j % 2 == 0;
            ASSERT_EQ(apart.x * apart.x + apart.y * apart.y + apart.z * apart.z, even ? 0 : 2) << i << ' ' << j;
          }
        }
      }
    }
  }
}

TEST(TriangleTile, FloatsWouldMixUpTheVerticesOfFineTiles) {
  // The control: weights as shares of 1 in float, each level's corners halved from the one above.
  std::mt19937_64 random = seeded(605);
  int apart = 0, tiles = 0;
  for (; tiles < 1000; ++tiles) {
    const FacePath path = randomIcoTile(random, 26);
    std::array<glm::vec3, 3> corners{glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};
    for (int i = 0; i < path.level(); ++i) {
      const auto parent = corners;
      const auto digit = static_cast<std::size_t>(path.digit(i));
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = (digit == 3 ? parent[(k + 1) % 3] + parent[(k + 2) % 3] : parent[digit] + parent[k]) * 0.5f;
    }
    const Corners exact = cornersOf(path);
    bool differs = false;
    for (std::size_t k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis)
        differs =
            differs || static_cast<double>(corners[k][axis]) != std::ldexp(static_cast<double>(exact[k][axis]), -26);
    }
    apart += differs;
  }
  std::cout << "control, float: " << apart << " of " << tiles << " tiles of level 26 have other corners\n";
  EXPECT_GT(apart, tiles / 2);
}

}  // namespace
}  // namespace terrane

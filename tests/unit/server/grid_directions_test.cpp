#include "server/build/grid_directions.h"

#include <gtest/gtest.h>

#include <random>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "server/build/tile_topology.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

TEST(GridDirections, AreCubeGridDirectionsToTheBit) {
  std::mt19937_64 random(41);
  GridDirections directions;
  for (int round = 0; round < 300; ++round) {
    const int level = round % 31, face = static_cast<int>(random() % 6);
    const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
    // Every third tile touches an edge of its face, where the bits are shared.
    const std::uint32_t column = round % 3 == 0 ? last : static_cast<std::uint32_t>(random()) & last;
    const std::uint32_t row = static_cast<std::uint32_t>(random()) & last;
    const int levels = round % 2 == 0 ? 6 : 3, cells = 1 << levels;
    gridDirections(FacePath::cubeTile(face, level, column, row), cells, directions);
    const auto side = static_cast<std::size_t>(cells) + 1;
    ASSERT_EQ(directions.x.size(), side * side);
    for (std::size_t j = 0; j < side; ++j) {
      for (std::size_t i = 0; i < side; ++i) {
        const glm::dvec3 expected = cubeGridDirection(face, level + levels, (std::uint64_t{column} << levels) + i,
                                                      (std::uint64_t{row} << levels) + j);
        const glm::dvec3 got(directions.x[j * side + i], directions.y[j * side + i], directions.z[j * side + i]);
        ASSERT_TRUE(got == expected) << "level " << level << " vertex " << i << ' ' << j;
      }
    }
  }
}

TEST(GridDirections, AreIcoGridDirectionsToTheBit) {
  std::mt19937_64 random(42);
  GridDirections directions;
  for (int round = 0; round < 90; ++round) {
    const int levels = round % 2 == 0 ? 6 : 3, cells = 1 << levels;
    const FacePath path = test::randomIcoTile(random, round % 31);
    const TriangleTile tile = triangleTile(path);
    gridDirections(path, cells, directions);
    ASSERT_EQ(directions.x.size(), static_cast<std::size_t>(triangleGridSize(cells)));
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i + j <= cells; ++i) {
        const auto at = static_cast<std::size_t>(triangleGridIndex(cells, {i, j}));
        const glm::dvec3 got(directions.x[at], directions.y[at], directions.z[at]);
        ASSERT_TRUE(got == icoGridDirection(kIcoMap, path.face(), path.level() + levels,
                                            gridVertexWeights(tile, cells, {i, j})))
            << path.text() << " vertex " << i << ' ' << j;
      }
    }
  }
}

TEST(GridDirections, AlongAnEdgeAreThoseOfTheGridInTheOrderOfTheSkirts) {
  std::mt19937_64 random(43);
  constexpr int kCells = 16;
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    const auto topology = makeTileTopology(scheme, kCells);
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      FacePath path = FacePath::wholeFace(scheme, static_cast<int>(random() % 6));
      while (path.level() < level) path = path.child(static_cast<int>(random() % 4));
      GridDirections grid, edges;
      gridDirections(path, kCells, grid);
      for (std::size_t edge = 0; edge < topology->edgeCount(); ++edge)
        appendEdgeDirections(path, static_cast<int>(edge), kCells, edges);
      ASSERT_EQ(edges.x.size(), topology->skirtAnchors.size());
      for (std::size_t k = 0; k < edges.x.size(); ++k) {
        const std::uint32_t anchor = topology->skirtAnchors[k];
        ASSERT_EQ(edges.x[k], grid.x[anchor]) << path.text() << " skirt vertex " << k;
        ASSERT_EQ(edges.y[k], grid.y[anchor]) << path.text() << " skirt vertex " << k;
        ASSERT_EQ(edges.z[k], grid.z[anchor]) << path.text() << " skirt vertex " << k;
      }
    }
  }
}

}  // namespace
}  // namespace terrane

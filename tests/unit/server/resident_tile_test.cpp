// What culling is told of a tile's quarters, against the meshes that the builder makes: vertices in long double.

#include "proto/resident_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/tiling/triangle_grid.h"
#include "server/build/tile_topology.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

struct Vertex {
  long double x, y, z;
};
Vertex vertexOf(const Tile& tile, std::size_t index) {
  const auto coordinate = [&](int axis) {
    return std::ldexp(static_cast<long double>(tile.metadata.origin[axis] +
                                               tile.mesh.offsets[3 * index + static_cast<std::size_t>(axis)]),
                      tile.metadata.stepExponent);
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

bool boxContains(const OrientedBox& box, const Vertex& p) {
  for (const glm::dvec3& half : box.halfAxes) {
    const long double x = p.x - box.center.x, y = p.y - box.center.y, z = p.z - box.center.z;
    const long double along = x * half.x + y * half.y + z * half.z;
    const long double limit = static_cast<long double>(half.x) * half.x + static_cast<long double>(half.y) * half.y +
                              static_cast<long double>(half.z) * half.z;
    if (std::abs(along) > limit) return false;
  }
  return true;
}

/// The part of a square or triangle at a corner, or the triangle's middle; a skirt's vertices are those of its edge.
bool isOver(Scheme scheme, const GridVertex& at, int digit) {
  if (scheme == Scheme::Cube) return ((digit & 1) ? at.i >= 32 : at.i <= 32) && ((digit & 2) ? at.j >= 32 : at.j <= 32);
  const int towards[3] = {64 - at.i - at.j, at.i, at.j};
  if (digit < 3) return towards[digit] >= 32;
  return std::ranges::all_of(towards, [](int cells) { return cells <= 32; });
}

GridVertex gridPlace(Scheme scheme, int grid) {
  const auto topology = makeTileTopology(scheme, 64);
  const int surface = static_cast<int>(topology->gridVertexCount());
  if (grid >= surface) grid = static_cast<int>(topology->skirtAnchors[static_cast<std::size_t>(grid - surface)]);
  if (scheme == Scheme::Cube) return {grid % 65, grid / 65};
  int j = 0;
  while (grid > 64 - j) grid -= 65 - j++;
  return {grid, j};
}

class ResidentTileOf : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, ResidentTileOf, test::bothSchemes(), test::nameOfScheme);

TEST_P(ResidentTileOf, QuarterBoundsHoldEveryVertexOfTheirQuarter) {
  const TileBuilder builder(tiledBy(GetParam(), testMoon()), {}, bestSimdPath());
  std::vector<GridVertex> places;
  for (std::size_t k = 0; k < gridVertexCount(GetParam(), 64) + skirtVertexCount(GetParam(), 64); ++k)
    places.push_back(gridPlace(GetParam(), static_cast<int>(k)));
  const SelectionBody& body = builder.info().selection;
  std::mt19937_64 random(41);
  RecordProperty("seed", 41);
  int strangers = 0;
  for (int level = 0; level <= body.maxLevel; ++level) {
    const FacePath path = test::randomTile(random, GetParam(), level);
    const Tile tile = builder.buildMesh(path).value();
    const ResidentTile known = residentTile(tile, body.radiusMeters);
    for (int digit = 0; digit < 4; ++digit) {
      const HeightRange& heights = (*known.quarterHeights)[static_cast<std::size_t>(digit)];
      EXPECT_GE(heights.minMeters, tile.metadata.heights.minMeters - stepMeters(tile.metadata.stepExponent));
      EXPECT_LE(heights.maxMeters, tile.metadata.heights.maxMeters + stepMeters(tile.metadata.stepExponent));
      const OrientedBox box = tileQuarterBounds(path, digit, body.radiusMeters, heights, body.occluderRadiusMeters).box;
      for (std::size_t vertex = 0; vertex < tile.mesh.vertexCount(); ++vertex) {
        const bool inside = boxContains(box, vertexOf(tile, vertex));
        if (isOver(GetParam(), places[tile.mesh.gridIndices[vertex]], digit)) {
          ASSERT_TRUE(inside) << path.text() << " quarter " << digit << " vertex " << vertex;
        } else {
          strangers += inside ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(strangers, 50'000) << "the control: other quarters' vertices are outside";
}

}  // namespace
}  // namespace terrane

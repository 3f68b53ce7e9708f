// What culling is told of a tile's quarters, against the meshes that the builder makes: vertices in long double.

#include "proto/resident_tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/build/tile_builder.h"
#include "tests/support/moon_body.h"

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

/// In quarters of a grid of 64 cells; a skirt's vertices are those of its edge.
std::pair<int, int> gridPlace(int grid) {
  if (grid < 65 * 65) return {grid % 65, grid / 65};
  const int along = (grid - 65 * 65) % 65;
  const std::pair<int, int> places[] = {{along, 0}, {64, along}, {64 - along, 64}, {0, 64 - along}};
  return places[(grid - 65 * 65) / 65];
}

bool isOver(std::pair<int, int> place, int digit) {
  return ((digit & 1) ? place.first >= 32 : place.first <= 32) &&
         ((digit & 2) ? place.second >= 32 : place.second <= 32);
}

TEST(ResidentTile, QuarterBoundsHoldEveryVertexOfTheirQuarter) {
  const TileBuilder builder(testMoon(), {}, bestSimdPath());
  const SelectionBody& body = builder.info().selection;
  std::mt19937_64 random(41);
  RecordProperty("seed", 41);
  int strangers = 0;
  for (int level = 0; level <= body.maxLevel; ++level) {
    const std::uint32_t last = (1u << level) - 1u;
    const FacePath path =
        FacePath::cubeTile(static_cast<int>(random() % 6), level, static_cast<std::uint32_t>(random()) & last,
                           static_cast<std::uint32_t>(random()) & last);
    const Tile tile = builder.buildMesh(path).value();
    const ResidentTile known = residentTile(tile, body.radiusMeters);
    for (int digit = 0; digit < 4; ++digit) {
      const HeightRange& heights = (*known.quarterHeights)[static_cast<std::size_t>(digit)];
      EXPECT_GE(heights.minMeters, tile.metadata.heights.minMeters - stepMeters(tile.metadata.stepExponent));
      EXPECT_LE(heights.maxMeters, tile.metadata.heights.maxMeters + stepMeters(tile.metadata.stepExponent));
      const OrientedBox box = tileQuarterBounds(path, digit, body.radiusMeters, heights, body.occluderRadiusMeters).box;
      for (std::size_t vertex = 0; vertex < tile.mesh.vertexCount(); ++vertex) {
        const bool inside = boxContains(box, vertexOf(tile, vertex));
        if (isOver(gridPlace(tile.mesh.gridIndices[vertex]), digit)) {
          ASSERT_TRUE(inside) << path.text() << " quarter " << digit << " vertex " << vertex;
        } else {
          strangers += inside ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(strangers, 100'000) << "the control: other quarters' vertices are outside";
}

}  // namespace
}  // namespace terrane

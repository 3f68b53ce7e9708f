// Tiles that share an edge decode to the same coordinates on it: over all face edges and cube corners, and for random
// pairs of every level on bodies of every size.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "common/tiling/lattice.h"
#include "proto/gltf_tile.h"
#include "server/build/tile_builder.h"
#include "tests/support/edge_vertices.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

using namespace testing_support;

constexpr unsigned kSeed = 24;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kPairs = 400;
#else
constexpr int kPairs = 10'000;
#endif

/// A tile as a viewer gets it: from its bytes.
Tile decoded(const TileBuilder& builder, const FacePath& path) {
  const Result<BuiltTile> built = builder.build(path);
  EXPECT_TRUE(built.has_value()) << (built.has_error() ? built.error().text() : "");
  if (built.has_error()) return {};
  Result<Tile> tile = decodeTile(built->glb);
  EXPECT_TRUE(tile.has_value()) << (tile.has_error() ? tile.error().text() : "");
  return tile.has_value() ? std::move(*tile) : Tile{};
}

FacePath randomTile(std::mt19937_64& random, int level) {
  const std::uint64_t last = (std::uint64_t{1} << level) - 1;
  auto at = [&] {
    // A third of the tiles lie at a border of their face.
    switch (random() % 6) {
      case 0:
        return std::uint32_t{0};
      case 1:
        return static_cast<std::uint32_t>(last);
      default:
        return static_cast<std::uint32_t>(random() & last);
    }
  };
  const std::uint32_t column = at(), row = at();
  return FacePath::cubeTile(static_cast<int>(random() % 6), level, column, row);
}

TEST(Seam, AllTwentyFourFaceEdgesAgree) {
  const TileBuilder builder(testMoon(), {}, bestSimdPath());
  for (const int level : {0, 3}) {
    for (int face = 0; face < 6; ++face) {
      for (int side = 0; side < kEdgeCount; ++side) {
        const std::uint32_t last = (1u << level) - 1, middle = last / 2;
        const Side edge = static_cast<Side>(side);
        const std::uint32_t column = edge == Side::UMin ? 0 : edge == Side::UMax ? last : middle;
        const std::uint32_t row = edge == Side::VMin ? 0 : edge == Side::VMax ? last : middle;
        const FacePath path = FacePath::cubeTile(face, level, column, row);
        const std::optional<FacePath> neighbour = path.neighbour(edge);
        ASSERT_TRUE(neighbour.has_value());
        ASSERT_NE(neighbour->face(), face);
        expectSameEdge(decoded(builder, path), edge, decoded(builder, *neighbour));
      }
    }
  }
}

TEST(Seam, ThreeFacesAgreeInEachOfTheEightCubeCorners) {
  const TileBuilder builder(testMoon(), {.cellsPerEdge = 16, .draco = {}}, bestSimdPath());
  for (const int level : {0, 5, 30}) {
    // The lattice point nearest to each corner of the cube, by the signs of its coordinates.
    std::map<std::array<bool, 3>, std::vector<EdgeVertex>> corners;
    for (int face = 0; face < 6; ++face) {
      for (const bool uMax : {false, true}) {
        for (const bool vMax : {false, true}) {
          const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
          const Tile tile = decoded(builder, FacePath::cubeTile(face, level, uMax ? last : 0, vMax ? last : 0));
          const std::vector<EdgeVertex> edge = edgeVertices(tile, vMax ? Side::VMax : Side::VMin);
          const EdgeVertex& corner = uMax ? edge.back() : edge.front();
          corners[{corner.point.x > 0, corner.point.y > 0, corner.point.z > 0}].push_back(corner);
        }
      }
    }
    ASSERT_EQ(corners.size(), 8u);
    for (const auto& [signs, vertices] : corners) {
      ASSERT_EQ(vertices.size(), 3u);
      EXPECT_EQ(vertices[0], vertices[1]);
      EXPECT_EQ(vertices[0], vertices[2]);
    }
  }
}

/// Every level 0 .. cap of a body, its radius log-uniform over all that the lattice serves, relief and all.
void checkRandomPairs(int cellsPerEdge, int bodies, int pairs) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> share(0, 1);
  std::printf("seed %u, %d pairs of %d cells on %d bodies\n", kSeed, pairs, cellsPerEdge, bodies);
  for (int made = 0; made < bodies; ++made) {
    const double radius = made == 0   ? kMinRadiusMeters
                          : made == 1 ? kMaxRadiusMeters
                                      : kMinRadiusMeters * std::pow(kMaxRadiusMeters / kMinRadiusMeters, share(random));
    // Relief that was made for the Moon would turn a small body inside out, so those are bare.
    const FieldKind field = radius > 1e6 && radius < 1e7 ? FieldKind::Lunar : FieldKind::Sphere;
    const TileBuilder builder(testBody(field, radius), {.cellsPerEdge = cellsPerEdge, .draco = {}}, bestSimdPath());
    for (int pair = 0; pair < pairs / bodies; ++pair) {
      const FacePath path = randomTile(random, pair % (builder.info().selection.maxLevel + 1));
      const Side side = static_cast<Side>(random() % kEdgeCount);
      SCOPED_TRACE(testing::Message() << "radius " << radius);
      ASSERT_NO_FATAL_FAILURE(expectSameEdge(decoded(builder, path), side, decoded(builder, *path.neighbour(side))));
    }
  }
}

TEST(Seam, RandomNeighboursOfEveryLevelAndRadiusAgree) { checkRandomPairs(8, 50, kPairs); }
TEST(Seam, RandomNeighboursAgreeAtTheServedNumberOfCells) { checkRandomPairs(64, 10, kPairs / 50); }

TEST(Seam, TilesQuantisedInTheirOwnBoxesWouldNotAgree) {
  // The control: the same two meshes, each rounded to 16 bits of its own bounding box as encoders do by default.
  const TileBuilder builder(testMoon(), {.cellsPerEdge = 16, .draco = {}}, bestSimdPath());
  const FacePath path = *FacePath::parse("cube/0/0123"), beside = *path.neighbour(Side::UMax);
  const Result<Tile> a = builder.buildMesh(path), b = builder.buildMesh(beside);
  ASSERT_TRUE(a.has_value() && b.has_value());
  const auto inOwnBox = [](const Tile& tile, const LatticePoint& point, int axis) {
    std::uint16_t widest = *std::max_element(tile.mesh.offsets.begin(), tile.mesh.offsets.end());
    const double grain = widest / 65535.0;
    return static_cast<double>(tile.metadata.origin[axis]) +
           std::round(static_cast<double>(point[axis] - tile.metadata.origin[axis]) / grain) * grain;
  };
  int apart = 0;
  for (const EdgeVertex& vertex : edgeVertices(*a, Side::UMax))
    for (int axis = 0; axis < 3; ++axis) apart += inOwnBox(*a, vertex.point, axis) != inOwnBox(*b, vertex.point, axis);
  EXPECT_GT(apart, 10);
}

}  // namespace
}  // namespace terrane

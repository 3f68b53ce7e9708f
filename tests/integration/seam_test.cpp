// Tiles of either scheme that share an edge decode to the same coordinates, normals and colours on it: over all edges
// and corners of the cube and the icosahedron, and for random pairs of every level on bodies of every size, whatever
// their ground is.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "common/tiling/lattice.h"
#include "proto/gltf_tile.h"
#include "server/build/tile_builder.h"
#include "tests/support/edge_vertices.h"
#include "tests/support/grounds.h"
#include "tests/support/ico_points.h"
#include "tests/support/moon_body.h"
#include "tests/support/sanitizers.h"

namespace terrane {
namespace {

using namespace testing_support;

constexpr unsigned kSeed = 24;
constexpr int kPairs = test::kSanitized ? 400 : 10'000;

/// A tile as a viewer gets it: from its bytes.
Tile decoded(const TileBuilder& builder, const FacePath& path) {
  const Result<BuiltTile> built = builder.build(path);
  EXPECT_TRUE(built.has_value()) << (built.has_error() ? built.error().text() : "");
  if (built.has_error()) return {};
  Result<Tile> tile = decodeTile(built->glb);
  EXPECT_TRUE(tile.has_value()) << (tile.has_error() ? tile.error().text() : "");
  return tile.has_value() ? std::move(*tile) : Tile{};
}

FacePath randomCubeTile(std::mt19937_64& random, int level) {
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

FacePath randomTile(std::mt19937_64& random, Scheme scheme, int level) {
  return scheme == Scheme::Cube ? randomCubeTile(random, level) : test::randomIcoTile(random, level);
}

/// About in the middle of an edge of a face.
FacePath tileAtFaceEdge(Scheme scheme, int face, int edge, int level) {
  FacePath path = FacePath::wholeFace(scheme, face);
  if (scheme == Scheme::Ico) {
    while (path.level() < level) path = path.child((edge + (path.level() == 0 ? 1 : 2)) % 3);
    return path;
  }
  const std::uint32_t last = (1u << level) - 1, middle = last / 2;
  const Side side = static_cast<Side>(edge);
  const std::uint32_t column = side == Side::UMin ? 0 : side == Side::UMax ? last : middle;
  const std::uint32_t row = side == Side::VMin ? 0 : side == Side::VMax ? last : middle;
  return FacePath::cubeTile(face, level, column, row);
}

FacePath tileAtFaceCorner(Scheme scheme, int face, int corner, int level) {
  FacePath path = FacePath::wholeFace(scheme, face);
  while (path.level() < level) path = path.child(corner);  // of the cube too: a digit is a quadrant
  return path;
}

EdgeVertex cornerVertex(const Tile& tile, int corner) {
  if (tile.metadata.path.scheme() == Scheme::Ico) return edgeVertices(tile, (corner + 2) % 3).front();
  const std::vector<EdgeVertex> edge = edgeVertices(tile, corner & 2 ? Side::VMax : Side::VMin);
  return corner & 1 ? edge.back() : edge.front();
}

/// Which corner of the solid lies nearest to a point: of the cube by its signs.
int solidCorner(Scheme scheme, const LatticePoint& point) {
  if (scheme == Scheme::Cube) return (point.x > 0) + 2 * (point.y > 0) + 4 * (point.z > 0);
  const auto along = [&](int vertex) { return glm::dot(glm::dvec3(point), icosahedronVertex(vertex)); };
  int nearest = 0;
  for (int vertex = 1; vertex < kIcosahedronVertices; ++vertex)
    if (along(vertex) > along(nearest)) nearest = vertex;
  return nearest;
}

class Seam : public testing::TestWithParam<test::Ground> {};
INSTANTIATE_TEST_SUITE_P(Grounds, Seam, test::allGrounds(), test::nameOfGround);

TEST_P(Seam, AllEdgesOfFacesAgree) {
  const Scheme scheme = GetParam().scheme;
  const TileBuilder builder(test::bodyOf(GetParam()), {}, bestSimdPath());
  for (const int level : {0, 3}) {
    for (int face = 0; face < faceCount(scheme); ++face) {
      for (int edge = 0; edge < edgeCount(scheme); ++edge) {
        const FacePath path = tileAtFaceEdge(scheme, face, edge, level), beyond = tileBeyondEdge(path, edge);
        ASSERT_NE(beyond.face(), face);
        expectSameEdge(decoded(builder, path), edge, decoded(builder, beyond));
      }
    }
  }
}

TEST_P(Seam, AllFacesAgreeInEachCornerOfTheSolid) {
  const Scheme scheme = GetParam().scheme;
  const TileBuilder builder(test::bodyOf(GetParam()), {.cellsPerEdge = 16, .draco = {}}, bestSimdPath());
  for (const int level : {0, 5, builder.info().selection.maxLevel}) {
    std::map<int, std::vector<EdgeVertex>> corners;
    for (int face = 0; face < faceCount(scheme); ++face) {
      for (int corner = 0; corner < edgeCount(scheme); ++corner) {
        const EdgeVertex vertex = cornerVertex(decoded(builder, tileAtFaceCorner(scheme, face, corner, level)), corner);
        corners[solidCorner(scheme, vertex.point)].push_back(vertex);
      }
    }
    ASSERT_EQ(corners.size(), scheme == Scheme::Cube ? 8u : 12u);
    for (const auto& [corner, vertices] : corners) {
      ASSERT_EQ(vertices.size(), scheme == Scheme::Cube ? 3u : 5u);
      for (const EdgeVertex& vertex : vertices) EXPECT_EQ(vertex, vertices.front()) << "corner " << corner;
    }
  }
}

/// Every level 0 .. cap of a body, its radius log-uniform over all that the lattice serves, relief and all.
void checkRandomPairs(const test::Ground& ground, int cellsPerEdge, int bodies, int pairs) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> share(0, 1);
  std::printf("seed %u, %d pairs of %d cells on %d bodies\n", kSeed, pairs, cellsPerEdge, bodies);
  for (int made = 0; made < bodies; ++made) {
    const double radius = made == 0   ? kMinRadiusMeters
                          : made == 1 ? kMaxRadiusMeters
                                      : kMinRadiusMeters * std::pow(kMaxRadiusMeters / kMinRadiusMeters, share(random));
    // Relief that was made for the Moon would turn a small body inside out, so those are bare.
    const bool bare = ground.field == FieldKind::Lunar && (radius < 1e6 || radius > 1e7);
    const test::Ground fitting(ground.scheme, bare ? FieldKind::Sphere : ground.field);
    const TileBuilder builder(test::bodyOf(fitting, radius), {.cellsPerEdge = cellsPerEdge, .draco = {}},
                              bestSimdPath());
    for (int pair = 0; pair < pairs / bodies; ++pair) {
      const FacePath path = randomTile(random, ground.scheme, pair % (builder.info().selection.maxLevel + 1));
      const int edge = static_cast<int>(random() % static_cast<unsigned>(edgeCount(ground.scheme)));
      SCOPED_TRACE(testing::Message() << "radius " << radius);
      ASSERT_NO_FATAL_FAILURE(
          expectSameEdge(decoded(builder, path), edge, decoded(builder, tileBeyondEdge(path, edge))));
    }
  }
}

TEST_P(Seam, RandomNeighboursOfEveryLevelAndRadiusAgree) { checkRandomPairs(GetParam(), 8, 50, kPairs); }
TEST_P(Seam, RandomNeighboursAgreeAtTheServedNumberOfCells) { checkRandomPairs(GetParam(), 64, 10, kPairs / 50); }

TEST(SeamControl, TilesQuantisedInTheirOwnBoxesWouldNotAgree) {
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

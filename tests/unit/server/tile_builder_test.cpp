#include "server/build/tile_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>

#include "common/tiling/tile_bounds.h"
#include "common/tiling/triangle_grid.h"
#include "proto/gltf_tile.h"
#include "server/build/grid_directions.h"
#include "server/build/level_accuracy.h"
#include "server/build/tile_topology.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

using namespace test;

constexpr unsigned kSeed = 64;

class TilesBuilt : public OfScheme {
 protected:
  static std::size_t gridCount() { return gridVertexCount(GetParam(), 64); }
};
INSTANTIATE_TEST_SUITE_P(Grounds, TilesBuilt, allGrounds(), nameOfGround);

TEST_P(TilesBuilt, PutVerticesWhereTheFieldSaysWithinHalfAStepAndTheTolerance) {
  std::mt19937_64 random(kSeed);
  const auto field = makeHeightField(builder().body(), bestSimdPath());
  const double rounding = GetParam().field == FieldKind::Midpoint ? 1e-3 : kToleranceSteps;
  SurfaceSamples samples;
  GridDirections directions;
  for (int level = 0; level <= maxLevel(); level += 3) {
    const FacePath path = randomTile(random, level);
    const Tile tile = mesh(builder(), path);
    const double step = stepMeters(tile.metadata.stepExponent);
    gridDirections(path, 64, directions);
    for (int k = 0; k < 20; ++k) {
      const std::size_t vertex = random() % gridCount();
      const glm::dvec3 d(directions.x[vertex], directions.y[vertex], directions.z[vertex]);
      // One vertex on its own gives the height that it has in the tile, or, where the field is of the grid itself,
      // what rounding makes of its direction.
      field->evaluate({&d.x, &d.y, &d.z, 1, 1}, 2 * nominalTileWidthMeters(kMoon, level, GetParam()) / 64, samples);
      const glm::dvec3 off = (position(tile, vertex) - d * (kMoon + samples.heightMeters[0])) / step;
      EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), 0.5 + rounding) << path.text();
    }
  }
}

TEST_P(TilesBuilt, OfTheBareSphereHaveTheirDirectionsAsNormals) {
  const TileBuilder smooth(tiledBy(GetParam(), testBody(FieldKind::Sphere, kMoon, kBodySeed)), {}, bestSimdPath());
  for (const char* text : {"0", "3/0312", "5/33333"}) {
    const Tile tile = mesh(smooth, path(text));
    EXPECT_TRUE(tile.mesh.colors.empty());
    for (std::size_t vertex = 0; vertex < gridCount(); ++vertex) {
      const glm::dvec3 up = glm::normalize(position(tile, vertex));
      const float* n = tile.mesh.normals.data() + 3 * vertex;
      EXPECT_NEAR(glm::length(glm::dvec3(n[0], n[1], n[2]) - up), 0.0, 1e-4);
    }
  }
}

/// At each grid vertex the sum of its triangles' normals, by their areas; skirts left out.
std::vector<glm::dvec3> normalsOfMesh(const Tile& tile, std::size_t gridCount) {
  std::vector<glm::dvec3> normals(gridCount, glm::dvec3(0));
  for (std::size_t i = 0; i < tile.mesh.triangles.size(); i += 3) {
    const std::uint32_t* corners = tile.mesh.triangles.data() + i;
    if (std::max({corners[0], corners[1], corners[2]}) >= gridCount) continue;
    const glm::dvec3 a = position(tile, corners[0]);
    const glm::dvec3 normal = glm::cross(position(tile, corners[1]) - a, position(tile, corners[2]) - a);
    for (int k = 0; k < 3; ++k) normals[corners[k]] += normal;
  }
  return normals;
}

TEST_P(TilesBuilt, HaveNormalsThatStandOnTheSurface) {
  std::mt19937_64 random(kSeed);
  const std::vector<std::uint32_t> border = makeTileTopology(GetParam(), 64)->skirtAnchors;
  for (int level = 2; level <= maxLevel(); level += 4) {
    const Tile tile = mesh(builder(), randomTile(random, level));
    const std::vector<glm::dvec3> fromMesh = normalsOfMesh(tile, gridCount());
    // Mean angle to the normals of the mesh itself: it is sampled at two cells a wavelength, so single ones may differ
    // much.
    double sum = 0, control = 0;
    for (std::uint32_t vertex = 0; vertex < gridCount(); ++vertex) {
      const float* n = tile.mesh.normals.data() + 3 * static_cast<std::size_t>(vertex);
      EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1.0f, 1e-6f);
      if (std::ranges::count(border, vertex) > 0) continue;
      const glm::dvec3 expected = glm::normalize(fromMesh[vertex]);
      sum += glm::length(glm::dvec3(n[0], n[1], n[2]) - expected);
      control += glm::length(glm::normalize(position(tile, vertex)) - expected);
    }
    EXPECT_LT(sum, 0.7 * control) << "level " << level << ": no better than the sphere's normals";
  }
}

LatticePoint latticePoint(const Tile& tile, std::size_t vertex) {
  const std::uint16_t* offset = tile.mesh.offsets.data() + 3 * vertex;
  return tile.metadata.origin + LatticePoint(offset[0], offset[1], offset[2]);
}

/// The vertices that a child's grid has in common with its parent's: the child's and the parent's grid index.
std::vector<std::pair<std::size_t, std::size_t>> sharedWithParent(Scheme scheme, int digit) {
  std::vector<std::pair<std::size_t, std::size_t>> shared;
  for (int j = 0; j <= 64; j += 2) {
    for (int i = 0; i <= (scheme == Scheme::Cube ? 64 : 64 - j); i += 2) {
      if (scheme == Scheme::Cube) {
        shared.emplace_back(j * 65 + i, ((digit >> 1) * 32 + j / 2) * 65 + (digit & 1) * 32 + i / 2);
        continue;
      }
      const auto parents = parentGridVertices(digit, 64, {i, j});
      EXPECT_EQ(parents[0], parents[1]);
      shared.emplace_back(triangleGridIndex(64, {i, j}), triangleGridIndex(64, parents[0]));
    }
  }
  return shared;
}

TEST_P(TilesBuilt, OfABareSphereMeetTheirParentsVerticesWithinAStep) {
  const TileBuilder smooth(tiledBy(GetParam(), testBody(FieldKind::Sphere, kMoon, kBodySeed)), {}, bestSimdPath());
  std::mt19937_64 random(kSeed);
  for (int level = 0; level < smooth.info().selection.maxLevel; level += 3) {
    const FacePath path = randomTile(random, level);
    const Tile parent = mesh(smooth, path);
    for (int digit = 0; digit < 4; ++digit) {
      const Tile child = mesh(smooth, path.child(digit));
      ASSERT_EQ(child.metadata.stepExponent + 1, parent.metadata.stepExponent);
      for (const auto& [own, above] : sharedWithParent(GetParam(), digit)) {
        // The same point: rounded by half a step of its own to either side, and by a whole one in the parent.
        const LatticePoint apart = latticePoint(child, own) - latticePoint(parent, above) * std::int64_t{2};
        for (int axis = 0; axis < 3; ++axis) ASSERT_LE(std::abs(apart[axis]), 1) << path.text() << " child " << digit;
      }
    }
  }
}

TEST_P(TilesBuilt, FitIntoSixteenBits) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  std::uint16_t largest = 0;
  const auto take = [&](const FacePath& path) {
    const Tile tile = mesh(builder(), path);
    largest = std::max(largest, *std::max_element(tile.mesh.offsets.begin(), tile.mesh.offsets.end()));
  };
  for (int face = 0; face < faceCount(GetParam()); ++face) take(FacePath::wholeFace(GetParam(), face));
  for (int level = 1; level <= maxLevel(); ++level)
    for (int k = 0; k < 4; ++k) take(randomTile(random, level));
  std::printf("largest offset %u of %d\n", largest, kTileOffsetMax);
}

TEST_P(TilesBuilt, ThatReliefMakesTooSteepForSixteenBitsAreOneClearError) {
  Body body = builder().body();
  body.fieldParameters["roughness"] = 100;  // fifty times what a scene may say
  if (GetParam().field == FieldKind::Midpoint) body.fieldParameters["amplitude"] *= 15;
  const TileBuilder steep(body, {}, bestSimdPath());
  std::mt19937_64 random(kSeed);
  int fitting = 0, refused = 0;
  for (int k = 0; k < 200; ++k) {
    const Result<Tile> tile = steep.buildMesh(randomTile(random, k % (steep.info().selection.maxLevel + 1)));
    fitting += tile.has_value() ? 1 : 0;
    if (tile.has_value()) continue;
    ++refused;
    EXPECT_EQ(tile.error().kind, ErrorKind::TooLarge);
    EXPECT_EQ(tile.error().field, "digits");
  }
  EXPECT_GT(fitting, 0);
  EXPECT_GT(refused, 0);
}

/// How far outside a tile's volumes its own or a descendant's vertex lies, in metres; the lattice's rounding is inside
/// them.
void expectInside(const TileBuilder& builder, const Tile& descendant, const Tile& tile) {
  const TileBounds bounds = tileBounds(tile.metadata.path, kMoon, tile.metadata.subtreeHeights,
                                       builder.info().selection.occluderRadiusMeters);
  const HeightRange& range = tile.metadata.subtreeHeights;
  const double rounding = stepMeters(descendant.metadata.stepExponent);
  for (std::size_t vertex = 0; vertex < descendant.mesh.vertexCount(); ++vertex) {
    const glm::dvec3 p = position(descendant, vertex);
    const double height = glm::length(p) - kMoon;
    ASSERT_GE(height, range.minMeters - rounding)
        << descendant.metadata.path.text() << " below " << tile.metadata.path.text();
    ASSERT_LE(height, range.maxMeters + rounding)
        << descendant.metadata.path.text() << " above " << tile.metadata.path.text();
    ASSERT_LE(glm::length(p - bounds.sphere.center), bounds.sphere.radiusMeters) << descendant.metadata.path.text();
    for (const glm::dvec3& axis : bounds.box.halfAxes)
      ASSERT_LE(std::abs(glm::dot(p - bounds.box.center, axis)), glm::dot(axis, axis))
          << descendant.metadata.path.text();
  }
}

TEST_P(TilesBuilt, HoldAllDescendantsInTheirVolumes) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  for (int walk = 0; walk < 3; ++walk) {
    FacePath path =
        FacePath::wholeFace(GetParam(), static_cast<int>(random() % static_cast<unsigned>(faceCount(GetParam()))));
    std::vector<Tile> above{mesh(builder(), path)};
    while (path.level() < maxLevel()) {
      path = path.child(static_cast<int>(random() % 4));
      above.push_back(mesh(builder(), path));
      for (const Tile& ancestor : above) expectInside(builder(), above.back(), ancestor);
    }
  }
}

/// Where a mesh is worst: in the middle of a square cell, or of a triangle.
glm::dvec3 middleOfCell(const Tile& tile, std::uint64_t random) {
  const bool cube = tile.metadata.path.scheme() == Scheme::Cube;
  const std::uint32_t* corners = tile.mesh.triangles.data() + (cube ? 6 : 3) * (random % (64 * 64));
  const glm::dvec3 a = position(tile, corners[0]), b = position(tile, corners[1]), c = position(tile, corners[2]);
  return cube ? 0.5 * (a + c) : (a + b + c) / 3.0;
}

TEST_P(TilesBuilt, HaveAGeometricErrorThatFallsStrictlyAndHoldsForTheFinerLevels) {
  const std::vector<double>& errors = builder().info().selection.geometricErrorMeters;
  ASSERT_EQ(errors.size(), static_cast<std::size_t>(maxLevel()) + 1);
  for (std::size_t level = 1; level < errors.size(); ++level) EXPECT_LT(errors[level], errors[level - 1]);
  EXPECT_GT(errors.back(), 0);

  // Against the finest surface.
  std::mt19937_64 random(kSeed);
  const auto field = makeHeightField(builder().body(), bestSimdPath());
  SurfaceSamples samples;
  int allBeyond = 0, all = 0;
  for (int level = 0; level + 1 < static_cast<int>(errors.size()); level += 2) {
    const FacePath path = randomTile(random, level);
    const Tile tile = mesh(builder(), path);
    const double error = errors[static_cast<std::size_t>(level)];
    double largest = 0;
    int beyond = 0;
    constexpr int kSamples = 400;
    for (int k = 0; k < kSamples; ++k) {
      const glm::dvec3 onMesh = middleOfCell(tile, random());
      const glm::dvec3 d = glm::normalize(onMesh);
      field->evaluate({&d.x, &d.y, &d.z, 1, 1}, 0.0, samples);
      const double off = std::abs(glm::length(onMesh) - kMoon - samples.heightMeters[0]);
      largest = std::max(largest, off / error);
      beyond += off > error;
    }
    std::printf("level %2d: off by at most %.2f of the geometric error, %d of %d beyond\n", level, largest, beyond,
                kSamples);
    allBeyond += beyond;
    all += kSamples;
  }
  EXPECT_LE(allBeyond, all / 50);
}

TEST_P(TilesBuilt, AreRefusedWhereTheBodyHasNone) {
  const Result<Tile> deep = builder().buildMesh(FacePath::fromPackedDigits(GetParam(), 0, maxLevel() + 1, 0));
  ASSERT_TRUE(deep.has_error());
  EXPECT_EQ(deep.error().kind, ErrorKind::InvalidArgument);
  EXPECT_EQ(deep.error().field, "digits");
  const Scheme other = GetParam() == Scheme::Cube ? Scheme::Ico : Scheme::Cube;
  const Result<BuiltTile> foreign = builder().build(FacePath::wholeFace(other, 3));
  ASSERT_TRUE(foreign.has_error());
  EXPECT_EQ(foreign.error().kind, ErrorKind::InvalidArgument);
  EXPECT_EQ(foreign.error().field, "scheme");
}

TEST_P(TilesBuilt, DecodeToTheMeshThatWasEncoded) {
  for (const char* text : {"0", "4/0123012", "5/3333", "1/00000000000000000000"}) {
    const Result<BuiltTile> built = builder().build(path(text));
    ASSERT_TRUE(built.has_value());
    const Result<Tile> decoded = decodeTile(built->glb);
    ASSERT_TRUE(decoded.has_value()) << decoded.error().text();
    const Tile tile = mesh(builder(), path(text));
    EXPECT_EQ(decoded->metadata.path, path(text));
    EXPECT_TRUE(decoded->metadata.origin == tile.metadata.origin);
    EXPECT_EQ(decoded->metadata.subtreeHeights.maxMeters, tile.metadata.subtreeHeights.maxMeters);
    ASSERT_EQ(decoded->mesh.vertexCount(), gridCount() + skirtVertexCount(GetParam(), 64));
    for (std::size_t vertex = 0; vertex < decoded->mesh.vertexCount(); ++vertex)
      EXPECT_TRUE(position(*decoded, vertex) == position(tile, decoded->mesh.gridIndices[vertex]));
  }
}

TEST_P(TilesBuilt, AreNamedForViewersWithTheirBody) {
  const BodyInfo& info = builder().info();
  EXPECT_EQ(info.name, "moon");
  EXPECT_EQ(info.schemes, std::vector{GetParam().scheme});
  EXPECT_EQ(info.selection.scheme, GetParam());
  EXPECT_EQ(info.selection.maxLevel, terrane::maxLevel(kMoon, GetParam()));
  EXPECT_EQ(info.cellsPerEdge, 64);
  EXPECT_LT(info.selection.occluderRadiusMeters, kMoon + info.selection.heights.maxMeters);
  const Body other = bodyOf(GetParam(), kMoon, 2);
  EXPECT_NE(TileBuilder(other, {}, bestSimdPath()).info().revision, info.revision);
  EXPECT_NE(builderOf(Scheme::Cube).info().revision, builderOf(Scheme::Ico).info().revision);
}

}  // namespace
}  // namespace terrane

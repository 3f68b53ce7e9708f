#include "server/build/tile_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "proto/gltf_tile.h"
#include "server/build/tile_topology.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

constexpr double kMoon = 1'737'400.0;
constexpr unsigned kSeed = 64;
constexpr std::uint64_t kBodySeed = 1;
constexpr std::size_t kSide = 65;

const TileBuilder& moon() {
  static const TileBuilder builder(testMoon(kBodySeed), {}, bestSimdPath());
  return builder;
}

FacePath randomTile(std::mt19937_64& random, int level) {
  const std::uint64_t last = (std::uint64_t{1} << level) - 1;
  return FacePath::cubeTile(static_cast<int>(random() % 6), level, static_cast<std::uint32_t>(random() & last),
                            static_cast<std::uint32_t>(random() & last));
}

Tile mesh(const TileBuilder& builder, const FacePath& path) {
  Result<Tile> tile = builder.buildMesh(path);
  EXPECT_TRUE(tile.has_value()) << (tile.has_error() ? tile.error().text() : "");
  return tile.has_value() ? std::move(*tile) : Tile{};
}

glm::dvec3 position(const Tile& tile, std::size_t vertex) {
  const std::uint16_t* offset = tile.mesh.offsets.data() + 3 * vertex;
  return latticePosition(tile.metadata.origin + LatticePoint(offset[0], offset[1], offset[2]),
                         tile.metadata.stepExponent);
}

TEST(TileBuilder, PutsVerticesWhereTheFieldSaysWithinHalfAStep) {
  std::mt19937_64 random(kSeed);
  const auto field = makeHeightField(testMoon(kBodySeed), bestSimdPath());
  SurfaceSamples samples;
  for (int level = 0; level <= moon().info().selection.maxLevel; level += 3) {
    const FacePath path = randomTile(random, level);
    const Tile tile = mesh(moon(), path);
    const double step = stepMeters(tile.metadata.stepExponent);
    for (int k = 0; k < 20; ++k) {
      const std::size_t i = random() % kSide, j = random() % kSide;
      const glm::dvec3 d = cubeGridDirection(path.face(), level + 6, std::uint64_t{path.column()} * 64 + i,
                                             std::uint64_t{path.row()} * 64 + j);
      // One vertex on its own gives the height that it has in the tile.
      field->evaluate({&d.x, &d.y, &d.z, 1, 1}, 2 * nominalTileWidthMeters(kMoon, level) / 64, samples);
      const glm::dvec3 off = (position(tile, j * kSide + i) - d * (kMoon + samples.heightMeters[0])) / step;
      EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), 0.5 + 1e-6) << path.text();
    }
  }
}

TEST(TileBuilder, GivesTheBareSphereItsOwnDirectionsAsNormals) {
  const TileBuilder builder(testBody(FieldKind::Sphere, kMoon, kBodySeed), {}, bestSimdPath());
  for (const char* text : {"cube/0", "cube/3/0312", "cube/5/33333"}) {
    const Tile tile = mesh(builder, *FacePath::parse(text));
    EXPECT_TRUE(tile.mesh.colors.empty());
    for (std::size_t vertex = 0; vertex < kSide * kSide; ++vertex) {
      const glm::dvec3 up = glm::normalize(position(tile, vertex));
      const float* n = tile.mesh.normals.data() + 3 * vertex;
      EXPECT_NEAR(glm::length(glm::dvec3(n[0], n[1], n[2]) - up), 0.0, 1e-4);
    }
  }
}

TEST(TileBuilder, NormalsStandOnTheSurface) {
  std::mt19937_64 random(kSeed);
  for (int level = 2; level <= moon().info().selection.maxLevel; level += 4) {
    const Tile tile = mesh(moon(), randomTile(random, level));
    // Mean angle to the normals of the mesh itself: it is sampled at two cells a wavelength, so single ones may differ
    // much.
    double sum = 0, control = 0;
    for (std::size_t j = 1; j + 1 < kSide; ++j) {
      for (std::size_t i = 1; i + 1 < kSide; ++i) {
        const glm::dvec3 alongU = position(tile, j * kSide + i + 1) - position(tile, j * kSide + i - 1);
        const glm::dvec3 alongV = position(tile, (j + 1) * kSide + i) - position(tile, (j - 1) * kSide + i);
        const glm::dvec3 fromMesh = glm::normalize(glm::cross(alongU, alongV));
        const float* n = tile.mesh.normals.data() + 3 * (j * kSide + i);
        EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1.0f, 1e-6f);
        sum += glm::length(glm::dvec3(n[0], n[1], n[2]) - fromMesh);
        control += glm::length(glm::normalize(position(tile, j * kSide + i)) - fromMesh);
      }
    }
    EXPECT_LT(sum, 0.7 * control) << "level " << level << ": no better than the sphere's normals";
  }
}

TEST(TileBuilder, HangsSkirtsTowardsTheCentreLeaningALittleOutwards) {
  const Tile tile = mesh(moon(), *FacePath::parse("cube/1/2103"));
  const double step = stepMeters(tile.metadata.stepExponent);
  double deepest = 0;
  for (std::size_t k = 0; k < 4 * kSide; ++k) {
    const std::size_t vertex = kSide * kSide + k, anchor = makeTileTopology(64)->skirtAnchors[k];
    const glm::dvec3 edge = position(tile, anchor), bottom = position(tile, vertex);
    const double depth = glm::length(edge) - glm::length(bottom);
    EXPECT_GT(depth, step);
    EXPECT_LE(depth, static_cast<double>(tile.metadata.skirtMeters) + 2 * step);
    deepest = std::max(deepest, depth);
    // Both ends are rounded to the lattice: each is off by at most sqrt(3) / 2 steps.
    const glm::dvec3 lean = glm::normalize(bottom) - glm::normalize(edge);
    const glm::dvec3 fromMiddle = glm::normalize(edge) - glm::normalize(position(tile, kSide * kSide / 2));
    EXPECT_GT(glm::dot(lean, fromMiddle), 0.0) << "skirt vertex " << k;
    const double flare = k % kSide == 0 || k % kSide == 64 ? kSkirtCornerFlareSteps : kSkirtFlareSteps;
    EXPECT_LE(glm::length(lean), (flare + 1.7321) * step / (kMoon + tile.metadata.heights.minMeters));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(tile.mesh.normals[3 * anchor + axis], tile.mesh.normals[3 * vertex + axis]);
      EXPECT_EQ(tile.mesh.colors[3 * anchor + axis], tile.mesh.colors[3 * vertex + axis]);
    }
  }
  EXPECT_NEAR(deepest, static_cast<double>(tile.metadata.skirtMeters), 2 * step);
}

TEST(TileBuilder, LeavesNoWedgeBetweenTheSkirtsOfTwoEdges) {
  for (const char* text : {"cube/0", "cube/3/0", "cube/1/2103", "cube/4/333333", "cube/2/0123012301230123"}) {
    const Tile tile = mesh(moon(), *FacePath::parse(text));
    for (std::size_t edge = 0; edge < 4; ++edge) {
      const std::size_t end = kSide * kSide + edge * kSide + 64, start = kSide * kSide + (edge + 1) % 4 * kSide;
      EXPECT_EQ(position(tile, end), position(tile, start)) << text << " after edge " << edge;
    }
  }
}

TEST(TileBuilder, FitsEveryTileIntoSixteenBits) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  std::uint16_t largest = 0;
  for (int level = 0; level <= moon().info().selection.maxLevel; ++level) {
    for (int k = 0; k < 4; ++k) {
      const Tile tile = mesh(moon(), level == 0 ? FacePath::wholeFace(Scheme::Cube, k) : randomTile(random, level));
      largest = std::max(largest, *std::max_element(tile.mesh.offsets.begin(), tile.mesh.offsets.end()));
    }
  }
  std::printf("largest offset %u of %d\n", largest, kTileOffsetMax);
}

/// How far outside a tile's volumes its own or a descendant's vertex lies, in metres; the lattice's rounding is inside
/// them.
void expectInside(const Tile& descendant, const Tile& tile) {
  const TileBounds bounds =
      tileBounds(tile.metadata.path, kMoon, tile.metadata.subtreeHeights, moon().info().selection.occluderRadiusMeters);
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

TEST(TileBuilder, NoDescendantSticksOutOfATilesVolumes) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  for (int walk = 0; walk < 3; ++walk) {
    FacePath path = FacePath::wholeFace(Scheme::Cube, static_cast<int>(random() % 6));
    std::vector<Tile> above{mesh(moon(), path)};
    while (path.level() < moon().info().selection.maxLevel) {
      path = path.child(static_cast<int>(random() % 4));
      above.push_back(mesh(moon(), path));
      for (const Tile& ancestor : above) expectInside(above.back(), ancestor);
    }
  }
}

/// A row of points as straight lines between them, met along the vertical of a direction; all in one plane with the
/// centre.
double lineHeight(const std::vector<glm::dvec3>& row, const glm::dvec3& direction) {
  const auto along = [&](const glm::dvec3& p) {
    return glm::dot(p, glm::normalize(row.back() - row.front())) /
           glm::dot(p, glm::normalize(row.front() + row.back()));
  };
  std::size_t next = 1;
  while (next + 1 < row.size() && along(row[next]) < along(direction)) ++next;
  const glm::dvec3 &a = row[next - 1], &b = row[next];
  const double t = (along(direction) - along(a)) / (along(b) - along(a));
  return glm::length(a + (b - a) * t) - kMoon;
}

std::vector<glm::dvec3> rowOf(const Tile& tile, std::size_t first, std::size_t last) {
  std::vector<glm::dvec3> row;
  for (std::size_t vertex = first; vertex <= last; ++vertex) row.push_back(position(tile, vertex));
  return row;
}

TEST(TileBuilder, WhereLevelsMeetTheHigherSidesSkirtReachesBelowTheLowerSidesEdge) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  double deepest = 0;
  for (int round = 0; round < 60; ++round) {
    const int level = 1 + round % moon().info().selection.maxLevel;
    // A tile, and a coarser one beyond its VMin border, which must be a border of that one too.
    FacePath path = randomTile(random, level);
    while (path.row() % 2 != 0 || !path.neighbour(Side::VMin) || path.row() == 0)
      path = randomTile(random, std::max(level, 2));
    const Tile fine = mesh(moon(), path), coarse = mesh(moon(), path.neighbour(Side::VMin)->parent());
    const std::size_t half = (path.column() & 1u) * 32, lastRow = 64 * kSide;
    const std::vector<glm::dvec3> fineEdge = rowOf(fine, 0, 64),
                                  fineSkirt = rowOf(fine, kSide * kSide, kSide * kSide + 64);
    const std::vector<glm::dvec3> coarseEdge = rowOf(coarse, lastRow + half, lastRow + half + 32);
    // VMax skirts run against u.
    const std::size_t skirt = kSide * kSide + 2 * kSide + 64 - half;
    std::vector<glm::dvec3> coarseSkirt = rowOf(coarse, skirt - 32, skirt);
    std::reverse(coarseSkirt.begin(), coarseSkirt.end());
    for (int k = 0; k <= 256; ++k) {
      const double share = std::clamp(k / 256.0, 1e-3, 1 - 1e-3);
      const glm::dvec3 direction = glm::normalize(fineEdge.front() * (1 - share) + fineEdge.back() * share);
      const double above = lineHeight(fineEdge, direction), below = lineHeight(coarseEdge, direction);
      EXPECT_LE(lineHeight(fineSkirt, direction), below) << path.text();
      EXPECT_LE(lineHeight(coarseSkirt, direction), above) << path.text();
    }
    deepest = std::max(deepest, fine.metadata.skirtMeters / (nominalTileWidthMeters(kMoon, path.level()) / 64));
  }
  std::printf("deepest skirt: %.2f cells\n", deepest);
}

TEST(TileBuilder, GroundIsNoSteeperThanSkirtsTakeForGranted) {
  std::mt19937_64 random(kSeed);
  double steepest = 0;
  for (int level = 0; level <= moon().info().selection.maxLevel; ++level) {
    const Tile tile = mesh(moon(), randomTile(random, level));
    for (std::size_t k = 0; k < 64; ++k) {
      const glm::dvec3 a = position(tile, k), b = position(tile, k + 1);
      steepest = std::max(steepest, std::abs(glm::length(a) - glm::length(b)) /
                                        (kMoon * glm::length(glm::normalize(a) - glm::normalize(b))));
    }
  }
  std::printf("steepest edge: %.2f\n", steepest);
  EXPECT_LE(steepest, 5.0);
}

TEST(TileBuilder, GeometricErrorFallsStrictlyAndHoldsForTheFinerLevels) {
  const std::vector<double>& errors = moon().info().selection.geometricErrorMeters;
  ASSERT_EQ(errors.size(), static_cast<std::size_t>(moon().info().selection.maxLevel) + 1);
  for (std::size_t level = 1; level < errors.size(); ++level) EXPECT_LT(errors[level], errors[level - 1]);
  EXPECT_GT(errors.back(), 0);

  // Against the finest surface, at the middles of cells, where a mesh is worst.
  std::mt19937_64 random(kSeed);
  const auto field = makeHeightField(testMoon(kBodySeed), bestSimdPath());
  SurfaceSamples samples;
  int allBeyond = 0, all = 0;
  for (int level = 0; level + 1 < static_cast<int>(errors.size()); level += 2) {
    const FacePath path = randomTile(random, level);
    const Tile tile = mesh(moon(), path);
    const double error = errors[static_cast<std::size_t>(level)];
    double largest = 0;
    int beyond = 0;
    constexpr int kSamples = 400;
    for (int k = 0; k < kSamples; ++k) {
      const std::size_t i = random() % 64, j = random() % 64;
      const glm::dvec3 onMesh = 0.5 * (position(tile, j * kSide + i) + position(tile, (j + 1) * kSide + i + 1));
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

TEST(TileBuilder, RefusesWhatTheBodyDoesNotHave) {
  const FacePath tooDeep = FacePath::cubeTile(0, moon().info().selection.maxLevel + 1, 0, 0);
  const Result<Tile> deep = moon().buildMesh(tooDeep);
  ASSERT_TRUE(deep.has_error());
  EXPECT_EQ(deep.error().kind, ErrorKind::InvalidArgument);
  EXPECT_EQ(deep.error().field, "digits");
  const Result<BuiltTile> ico = moon().build(FacePath::wholeFace(Scheme::Ico, 3));
  ASSERT_TRUE(ico.has_error());
  EXPECT_EQ(ico.error().field, "scheme");
}

TEST(TileBuilder, EncodesTheMeshThatItBuilt) {
  const FacePath path = *FacePath::parse("cube/4/0123012");
  const Result<BuiltTile> built = moon().build(path);
  ASSERT_TRUE(built.has_value());
  const Result<Tile> decoded = decodeTile(built->glb);
  ASSERT_TRUE(decoded.has_value()) << decoded.error().text();
  const Tile tile = mesh(moon(), path);
  EXPECT_EQ(decoded->metadata.path, path);
  EXPECT_TRUE(decoded->metadata.origin == tile.metadata.origin);
  EXPECT_EQ(decoded->metadata.subtreeHeights.maxMeters, tile.metadata.subtreeHeights.maxMeters);
  ASSERT_EQ(decoded->mesh.vertexCount(), tile.mesh.vertexCount());
  for (std::size_t vertex = 0; vertex < decoded->mesh.vertexCount(); ++vertex)
    EXPECT_TRUE(position(*decoded, vertex) == position(tile, decoded->mesh.gridIndices[vertex]));
}

TEST(TileBuilder, NamesTheBodyForViewers) {
  const BodyInfo& info = moon().info();
  EXPECT_EQ(info.name, "moon");
  EXPECT_EQ(info.selection.maxLevel, maxLevel(kMoon));
  EXPECT_EQ(info.cellsPerEdge, 64);
  EXPECT_LT(info.selection.occluderRadiusMeters, kMoon + info.selection.heights.maxMeters);
  const Body other = testMoon(2);
  EXPECT_NE(TileBuilder(other, {}, bestSimdPath()).info().revision, info.revision);
}

}  // namespace
}  // namespace terrane

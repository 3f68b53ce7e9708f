// Grains on the ground: where they stand, what they do to the picture, and that a change of level does nothing to it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/render/dust_instances.h"
#include "client/render/tile_indices.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/stitched_tiles.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr double kMoonRadius = 1'737'400.0;
constexpr std::uint64_t kSeed = 20261126;

std::vector<EffectCall> effects(bool sun, bool dust) {
  std::vector<EffectCall> calls = shippedScene("moon").effects;
  std::erase_if(calls, [&](const EffectCall& call) {
    return call.kind == EffectKind::Detail || (call.kind == EffectKind::Sun && !sun) ||
           (call.kind == EffectKind::Dust && !dust);
  });
  return calls;
}

DustSettings moonDust() {
  DustSettings settings;
  for (const EffectCall& call : effects(false, true))
    settings = {call.parameters.at("cover"), call.parameters.at("smallest"), call.parameters.at("largest")};
  return settings;
}

class DustTest : public GlTest {
 protected:
  static std::unique_ptr<TileRenderer> rendererOf(const std::vector<EffectCall>& calls, bool baseline = false) {
    return makeRenderer(calls, {.forceBaseline = baseline, .bodyRadiusMeters = kMoonRadius});
  }
  static Image picture(TileRenderer& renderer, const Camera& camera, const std::vector<DrawnTile>& tiles,
                       const DrawSettings& settings = {}, int samples = 1) {
    auto target = RenderTarget::create(camera.widthPixels, camera.heightPixels, TargetFormat::Rgba8, samples);
    EXPECT_TRUE(target);
    target->bind();
    EXPECT_EQ(renderer.draw(camera, tiles, settings).tiles, tiles.size());
    target->bindForReading();
    Image image = readFramebuffer(camera.widthPixels, camera.heightPixels);
    RenderTarget::bindWindow();
    return image;
  }
  /// Where the pictures of the Moon's ground are taken.
  static Camera cameraAbove(double meters, double pitchDegrees) {
    return moon().cameraAboveGround({-16.4018 * kDegree, 21.6039 * kDegree, meters, 0, pitchDegrees * kDegree}, kWidth,
                                    kHeight);
  }
  static std::vector<DrawnTile> settled(TileRenderer& renderer, const Camera& camera) {
    const std::vector<FacePath> paths = moon().settledTiles(camera, 2);
    for (const FacePath& path : paths) {
      renderer.upload(moon().tile(path));
      renderer.upload(moon().tile(path.parent()));
    }
    return stitchedTiles(paths);
  }
};

double perMillion(const Image& a, const Image& b) {
  std::size_t strong = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.rgb[i + c] - b.rgb[i + c]));
    strong += most > 8 ? 1u : 0u;
  }
  return 1e6 * static_cast<double>(strong) / (static_cast<double>(a.rgb.size()) / 3);
}

/// 64 bits of a coordinate: the reference.
using Wide = std::array<long double, 3>;

Wide morphedVertex(const Tile& tile, const Tile& parent, const TileMorph& morph, const GridVertex& at) {
  const MorphGrid grid = *morphGrid(tile.metadata, parent.metadata);
  const ParentVertices to = grid.parentVertices(at);
  const int vertex = grid.grid.index(at);
  const auto share = static_cast<long double>(morphByBorders(grid.grid, morph)[grid.grid.borders(at)]);
  const auto step = static_cast<long double>(stepMeters(tile.metadata.stepExponent));
  Wide place{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const auto offset = [&](const Tile& of, int index) {
      return static_cast<std::int64_t>(of.mesh.offsets[3 * static_cast<std::size_t>(index) + k]);
    };
    const std::int64_t own = tile.metadata.origin[axis] + offset(tile, vertex);
    const std::int64_t target = 2 * parent.metadata.origin[axis] + offset(parent, to.first) + offset(parent, to.second);
    place[k] = (static_cast<long double>(own) + share * static_cast<long double>(target - own)) * step;
  }
  return place;
}

/// By every triangle that is drawn; the mesh must be in grid order, as the builder gives it.
Wide groundAt(const Tile& tile, const Tile& parent, const TileMorph& morph, const std::vector<std::uint16_t>& triangles,
              const glm::dvec2& cells) {
  std::vector<GridVertex> vertices;  // by grid index
  const TileGrid grid{tile.metadata.path.scheme(), kGrainCells};
  for (int j = 0; j <= grid.cells; ++j)
    for (int i = 0; i <= grid.rowEnd(j); ++i) vertices.push_back({i, j});
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    std::array<glm::dvec2, 3> plan;
    for (std::size_t k = 0; k < 3; ++k) plan[k] = {vertices[triangles[t + k]].i, vertices[triangles[t + k]].j};
    const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
    const double area = cross(plan[1] - plan[0], plan[2] - plan[0]);
    std::array<double, 3> weight{};
    for (std::size_t k = 0; k < 3; ++k) weight[k] = cross(plan[(k + 1) % 3] - cells, plan[(k + 2) % 3] - cells) / area;
    if (std::ranges::any_of(weight, [](double w) { return w < 0; })) continue;
    Wide sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Wide vertex = morphedVertex(tile, parent, morph, vertices[triangles[t + k]]);
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += static_cast<long double>(weight[k]) * vertex[axis];
    }
    return sum;
  }
  ADD_FAILURE() << "no triangle is drawn at " << cells.x << ", " << cells.y;
  return {};
}

class DustOfSchemes : public DustTest, public testing::WithParamInterface<Scheme> {};

TEST_P(DustOfSchemes, GrainsStandOnTheGroundThatIsDrawn) {
  // A double-float holds 48 bits of a coordinate: 2^-48 of the Moon's radius is 6.2 nm; sums in double take the rest.
  constexpr double kBoundMeters = 8e-9;
  std::mt19937_64 random(kSeed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const GrainField field(moonDust(), kMoonRadius, GetParam());
  TileSource& source = moon(GetParam());
  double worst = 0, moved = 0;
  std::size_t count = 0;
  for (int round = 0; round < 18; ++round) {
    const int level = 20 + round % 6;
    FacePath path = FacePath::wholeFace(GetParam(), round % 6);
    while (path.level() < level) path = path.child(static_cast<int>(random() % 4));
    const auto tile = source.tile(path), parent = source.tile(path.parent());
    GpuTiles tiles;
    tiles.upload(*tile);
    tiles.upload(*parent);
    TileMorph morph = morphedBy(0.125f * static_cast<float>(random() % 9));
    morph.coarserEdges = static_cast<std::uint8_t>(random() % (1u << edgeCount(GetParam())));
    for (int edge = 0; edge < edgeCount(GetParam()); ++edge)
      if (((morph.coarserEdges >> edge) & 1) != 0) morph.sides[static_cast<std::size_t>(edge)] = 1;
    const auto draw = makeTileDraw(tiles, {path, morph}, false, 1u << 20);
    ASSERT_TRUE(draw);
    if (draw->parent == nullptr) continue;  // nothing morphs
    const TileGrains grains(field, *draw);
    const std::vector<std::uint16_t> triangles = gridTriangles({GetParam(), kGrainCells}, morph.coarserEdges),
                                     unstitched = gridTriangles({GetParam(), kGrainCells}, 0);
    std::size_t i = 0;
    for (int classLevel = field.coarsestClass(); classLevel <= level - kFinestClassBelow; ++classLevel) {
      std::vector<Grain> listed;
      field.collect(path, classLevel, listed);
      for (const Grain& grain : listed) {
        const GrainInstance& instance = grains.instances().at(i++);
        const Wide ground = groundAt(*tile, *parent, morph, triangles, grain.cells),
                   own = groundAt(*tile, *parent, {}, unstitched, grain.cells);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const long double root = static_cast<long double>(instance.rootHigh[axis]) + instance.rootLow[axis];
          worst = std::max(worst, static_cast<double>(std::abs(root - ground[axis])));
          moved = std::max(moved, static_cast<double>(std::abs(own[axis] - ground[axis])));
        }
        ++count;
      }
    }
    EXPECT_EQ(i, grains.instances().size());
  }
  std::printf("%zu roots at most %.1f nm off the drawn ground, which the morph moves by up to %.1f um\n", count,
              worst * 1e9, moved * 1e6);
  EXPECT_GT(count, 500u);
  EXPECT_LE(worst, kBoundMeters);
  EXPECT_GT(moved, 100 * kBoundMeters);
}

INSTANTIATE_TEST_SUITE_P(Schemes, DustOfSchemes, test::bothSchemes(), test::nameOfScheme);

TEST_F(DustTest, AGpuThatCannotAddDoubleFloatsIsGivenRootsFromTheCamera) {
  const Camera camera = cameraAbove(0.5, -40);
  GpuTiles tiles;
  std::vector<TileDraw> draws;
  for (const FacePath& path : moon().settledTiles(camera, 2)) {
    tiles.upload(*moon().tile(path));
    draws.push_back(*makeTileDraw(tiles, {path, {}}, false, 1u << 20));
  }
  DustInstances exact(moonDust(), kMoonRadius, Scheme::Cube, false),
      relative(moonDust(), kMoonRadius, Scheme::Cube, true);
  exact.gather(camera, draws);
  relative.gather(camera, draws);
  std::size_t count = 0;
  for (int mesh = 0; mesh < kGrainMeshes; ++mesh) {
    const auto &roots = exact.ofMesh(mesh), &fromCamera = relative.ofMesh(mesh);
    ASSERT_EQ(roots.size(), fromCamera.size());
    for (std::size_t i = 0; i < roots.size(); ++i, ++count)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double there = static_cast<double>(roots[i].rootHigh[axis]) + static_cast<double>(roots[i].rootLow[axis]);
        const double expected = there - camera.positionBody[static_cast<int>(axis)];
        EXPECT_NEAR(fromCamera[i].rootHigh[axis], expected, 8e-9 + 0x1p-24 * std::abs(expected));
        EXPECT_EQ(fromCamera[i].rootLow[axis], 0.0f);
      }
  }
  std::printf("%zu grains in view from 0.5 m\n", count);
  EXPECT_GT(count, 300u);
  relative.gather(camera, {});
  EXPECT_EQ(relative.tilesKept(), 0u) << "what is not drawn is not kept";
}

TEST_F(DustTest, ASceneThatDoesNotNameItHasNothingOfIt) {
  const Camera camera = cameraAbove(0.5, -20);
  resetConstructionCounts();
  auto without = rendererOf(effects(true, false));
  EXPECT_EQ(constructionCounts(), (std::vector<std::pair<std::string, int>>{{"effect.sun", 1}}));
  auto with = rendererOf(effects(true, true));
  const auto tiles = settled(*without, camera);
  settled(*with, camera);
  const Image bare = picture(*without, camera, tiles),
              switchedOff = picture(*with, camera, tiles, {.effectPasses = false}),
              dusty = picture(*with, camera, tiles);
  EXPECT_GT(with->gpuBytes(), without->gpuBytes()) << "its meshes, instances and depth";
  EXPECT_EQ(bare.rgb, switchedOff.rgb);
  EXPECT_GT(perMillion(bare, dusty), 5000) << "the control: with dust it is another picture";
}

TEST_F(DustTest, IsTheSameEveryTimeAndOnTheBaselinePath) {
  const Camera camera = cameraAbove(0.5, -30);
  auto first = rendererOf(effects(true, true)), second = rendererOf(effects(true, true)),
       baseline = rendererOf(effects(true, true), true);
  const auto tiles = settled(*first, camera);
  settled(*second, camera);
  settled(*baseline, camera);
  const Image one = picture(*first, camera, tiles);
  EXPECT_EQ(one.rgb, picture(*second, camera, tiles).rgb);
  picture(*first, cameraAbove(2, -30), settled(*first, cameraAbove(2, -30)));
  EXPECT_EQ(one.rgb, picture(*first, camera, tiles).rgb) << "after another view";
  const Image plain = picture(*baseline, camera, tiles);
  std::printf("baseline: RMS %.3f of 255, %.0f pixels per million\n", rmsDifference(one, plain),
              perMillion(one, plain));
  EXPECT_LE(rmsDifference(one, plain), 1.0);
}

TEST_F(DustTest, SeveralSamplesAPixelShowTheSamePicture) {
  const Camera camera = cameraAbove(0.2, -30);
  auto renderer = rendererOf(effects(true, true));
  const auto tiles = settled(*renderer, camera);
  const Image one = picture(*renderer, camera, tiles), four = picture(*renderer, camera, tiles, {}, 4),
              bare = picture(*renderer, camera, tiles, {.effectPasses = false});
  std::printf("4 samples: RMS %.2f of 255 apart; dust is %.2f\n", rmsDifference(one, four), rmsDifference(one, bare));
  EXPECT_LT(rmsDifference(one, four), 0.5 * rmsDifference(one, bare));
}

TEST_F(DustTest, ASplitChangesNothingThatAnyoneSees) {
  auto renderer = rendererOf(effects(true, true));
  const Camera camera = cameraAbove(0.5, -50);
  const std::vector<DrawnTile> before = settled(*renderer, camera);
  int splits = 0;
  double worstRms = 0, worstPerMillion = 0, control = 0;
  const Image first = picture(*renderer, camera, before);
  const Image bare = picture(*renderer, camera, before, {.effectPasses = false});
  for (std::size_t i = 0; i < before.size() && splits < 12; ++i) {
    if (before[i].morph != TileMorph{}) continue;  // only a tile that is its own surface all around may split
    std::vector<DrawnTile> after = before, grown = before;
    after.erase(after.begin() + static_cast<std::ptrdiff_t>(i));
    grown = after;
    for (int digit = 0; digit < 4; ++digit) {
      const FacePath child = before[i].path.child(digit);
      renderer->upload(moon().tile(child));
      after.push_back({child, morphedBy(1)});
      grown.push_back({child, {}});
    }
    const Image split = picture(*renderer, camera, after);
    worstRms = std::max(worstRms, rmsDifference(first, split));
    worstPerMillion = std::max(worstPerMillion, perMillion(first, split));
    control = std::max(control, perMillion(first, picture(*renderer, camera, grown)));
    ++splits;
  }
  std::printf("%d splits: RMS %.4f of 255, %.1f pixels per million; control, not morphed: %.0f; dust itself: %.0f\n",
              splits, worstRms, worstPerMillion, control, perMillion(first, bare));
  EXPECT_GE(splits, 4);
  EXPECT_LE(worstRms, 1.0);
  EXPECT_LE(worstPerMillion, 10.0);
  EXPECT_GT(control, 100.0);
}

struct Ratio {
  double sum = 0;
  int count = 0;
  double mean() const { return sum / count; }
};

/// Adds the ratio of brightness with dust to without, on the ground beside the grains in view, so many half widths from
/// their roots in the sun's direction along the ground (negative: away from it).
void besideGrains(const Camera& camera, const DustInstances& grains, const Image& dusty, const Image& bare,
                  double halfWidths, Ratio& ratio) {
  const double longitude = 52 * kDegree, latitude = 8 * kDegree;
  const glm::dvec3 sun(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                       std::sin(latitude));
  for (int mesh = 0; mesh < kGrainMeshes; ++mesh) {
    for (const GrainInstance& grain : grains.ofMesh(mesh)) {
      const glm::dvec3 root(grain.rootHigh[0], grain.rootHigh[1], grain.rootHigh[2]),
          up = glm::normalize(root + camera.positionBody);
      const double radius = static_cast<double>(grain.radiusMeters);
      if (radius * pixelsPerRadian(camera) / glm::length(root) < 3) continue;
      const glm::dvec3 along = glm::normalize(sun - glm::dot(sun, up) * up), at = root + halfWidths * radius * along;
      const double depth = -glm::dot(camera.backward, at), scale = pixelsPerRadian(camera) / depth;
      const double x = kWidth / 2.0 + glm::dot(camera.right, at) * scale,
                   y = kHeight / 2.0 - glm::dot(camera.up, at) * scale;
      if (!(x >= 0 && y >= 0 && x < kWidth && y < kHeight)) continue;
      const auto pixel = 3 * (static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x));
      if (bare.rgb[pixel] < 40) continue;  // in the dark already
      ratio.sum += static_cast<double>(dusty.rgb[pixel]) / bare.rgb[pixel];
      ++ratio.count;
    }
  }
}

TEST_F(DustTest, GrainsCastShadowsAwayFromTheSunAndDimTheGroundAtTheirFoot) {
  const DustSettings settings = moonDust();
  for (const bool sun : {true, false}) {
    auto renderer = rendererOf(effects(sun, true));
    Ratio away, towards, far;
    for (int place = 0; place < 6; ++place) {
      const Camera camera = moon().cameraAboveGround(
          {(-16.4 + 0.01 * place) * kDegree, 21.6 * kDegree, 0.3, 0, -90 * kDegree}, kWidth, kHeight);
      const auto tiles = settled(*renderer, camera);
      const Image dusty = picture(*renderer, camera, tiles),
                  bare = picture(*renderer, camera, tiles, {.effectPasses = false});
      DustInstances grains(settings, kMoonRadius, Scheme::Cube, true);
      GpuTiles uploaded;
      std::vector<TileDraw> draws;
      for (const DrawnTile& tile : tiles) {
        uploaded.upload(*moon().tile(tile.path));
        draws.push_back(*makeTileDraw(uploaded, {tile.path, {}}, false, 1u << 20));
      }
      grains.gather(camera, draws);
      besideGrains(camera, grains, dusty, bare, -1.4, away);
      besideGrains(camera, grains, dusty, bare, 1.2, towards);
      besideGrains(camera, grains, dusty, bare, 2.6, far);
    }
    std::printf(
        "%s: of the light on bare ground, away from the sun %.3f, towards it %.3f, two widths off %.3f; %d grains\n",
        sun ? "sun" : "no sun", away.mean(), towards.mean(), far.mean(), away.count);
    EXPECT_GE(away.count, 100);
    if (sun) {
      EXPECT_LT(away.mean(), 0.75 * towards.mean());
    } else {
      EXPECT_NEAR(away.mean(), towards.mean(), 0.06) << "no sun, no shadow";
      EXPECT_LT(towards.mean(), far.mean() - 0.01) << "dim at the foot";
    }
    EXPECT_GT(far.mean(), 0.85);
  }
}

}  // namespace
}  // namespace terrane

// Tiles between their own surface and their parent's: all the way there they are the parent, to the last bit and to the
// eye; on the way there they stay closed.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <random>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/render/morph_grid.h"
#include "common/tiling/tile_at.h"
#include "proto/gltf_tile.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/parent_tiles.h"
#include "tests/capture/stitched_tiles.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr int kCells = 64;
constexpr std::uint64_t kSeed = 20261126;
using TilePointer = std::shared_ptr<const Tile>;

class MorphTest : public GlTestOfSchemes {
 protected:
  static TilePointer built(const FacePath& path) {
    return std::make_shared<const Tile>(tiles().builder().buildMesh(path).value());
  }
  /// Above the tile's middle by so many of its widths.
  static Camera cameraOver(const Tile& tile, double widths) {
    const glm::dvec3 at = tile.metadata.sphere.center;
    const double width =
        nominalTileWidthMeters(moon().selection().radiusMeters, tile.metadata.path.level(), GetParam());
    const ViewPose pose{std::atan2(at.y, at.x), std::asin(at.z / glm::length(at)),
                        tile.metadata.heights.maxMeters + widths * width, 0.3, -80 * kDegree};
    return cameraFromPose(pose, moon().selection().radiusMeters, 0.9, kWidth, kHeight);
  }
  static Image picture(TileRenderer& renderer, const Camera& camera, const std::vector<DrawnTile>& tiles,
                       Placement placement) {
    auto target = RenderTarget::create(camera.widthPixels, camera.heightPixels);
    EXPECT_TRUE(target);
    target->bind();
    EXPECT_EQ(renderer.draw(camera, tiles, {.placement = placement}).tiles, tiles.size());
    Image image = readFramebuffer(camera.widthPixels, camera.heightPixels);
    RenderTarget::bindWindow();
    return image;
  }
};

TEST_P(MorphTest, EveryVertexMovesToAPointOfTheParentsMesh) {
  std::mt19937_64 random(kSeed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  std::size_t moved = 0, compared = 0;
  for (int round = 0; round < parentLevels(GetParam()); ++round) {
    const TilePointer parent = built(parentOf(GetParam(), random, round));
    for (int digit = 0; digit < 4; ++digit) {
      const TilePointer child = built(parent->metadata.path.child(digit));
      const auto grid = morphGrid(child->metadata, parent->metadata);
      ASSERT_TRUE(grid);
      for (int j = 0; j <= kCells; ++j) {
        for (int i = 0; i <= grid->grid.rowEnd(j); ++i, ++compared) {
          const ParentVertices to = grid->parentVertices({i, j});
          LatticePoint target = child->metadata.origin + LatticePoint(grid->parentMinusOwn);
          for (const int vertex : {to.first, to.second}) {
            const std::uint16_t* offset = &parent->mesh.offsets[3 * static_cast<std::size_t>(vertex)];
            target += LatticePoint(offset[0], offset[1], offset[2]);
          }
          const glm::ivec2 at = grid->firstInHalfCells() + grid->direction() * glm::ivec2(i, j);
          ASSERT_EQ(target, twiceMeshPoint(*parent, at.x, at.y))
              << child->metadata.path.text() << " vertex " << i << ' ' << j;
          moved += target == latticePoint(*child, i, j) ? 0 : 1;
        }
      }
    }
  }
  std::printf("%zu vertices, of which %zu move\n", compared, moved);
  EXPECT_GT(moved, compared / 2);
}

TEST(MorphGrid, RefusesWhatDoesNotFit) {
  TileMetadata parent, tile;
  parent.stepExponent = 1;
  tile.path = parent.path.child(3);
  ASSERT_TRUE(morphGrid(tile, parent));
  EXPECT_EQ(morphGrid(tile, parent)->firstInHalfCells(), glm::ivec2(64, 64));
  TileMetadata other = parent;
  other.stepExponent = 0;
  EXPECT_FALSE(morphGrid(tile, other));
  other = parent;
  other.cellsPerEdge = 32;
  EXPECT_FALSE(morphGrid(tile, other));
  other = parent;
  other.origin.y = 1 << 30;
  EXPECT_FALSE(morphGrid(tile, other));
  parent.cellsPerEdge = tile.cellsPerEdge = 33;
  EXPECT_FALSE(morphGrid(tile, parent)) << "an odd number of cells has no middle";
}

TEST_P(MorphTest, AVertexThatDoesNotMorphKeepsItsBitsInATileThatDoes) {
  auto renderer = makeRenderer();
  const TilePointer child = tiles().tile(GetParam() == Scheme::Cube ? FacePath::cubeTile(3, 11, 700, 701)
                                                                    : FacePath::parse("ico/3/01322310231").value());
  renderer->upload(child);
  renderer->upload(tiles().tile(child->metadata.path.parent()));
  const Camera camera = cameraOver(*child, 0.1);
  for (const Placement placement : {Placement::Integer, Placement::DoubleFloat, Placement::Cpu, Placement::Float32}) {
    TileMorph corner;
    corner.sides[static_cast<std::size_t>(kMostEdges + edgeCount(GetParam()) - 1)] = 0.5f;
    const auto plain = renderer->clipPositions(camera, {child->metadata.path, {}}, placement),
               morphed = renderer->clipPositions(camera, {child->metadata.path, corner}, placement);
    ASSERT_EQ(plain.size(), morphed.size());
    std::size_t differing = 0;
    for (std::size_t v = 0; v < plain.size() / 4; ++v)
      differing += std::equal(&plain[4 * v], &plain[4 * v] + 4, &morphed[4 * v]) ? 0u : 1u;
    EXPECT_EQ(differing, 1u) << placementName(placement) << ": only the corner moves";
  }
}

struct PictureDifference {
  double rms = 0;               ///< of 255
  double strongPerMillion = 0;  ///< pixels that differ by more than 8 of 255
};
PictureDifference compare(const Image& a, const Image& b) {
  std::size_t strong = 0;
  for (std::size_t pixel = 0; pixel < a.rgb.size() / 3; ++pixel) {
    int most = 0;
    for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.rgb[3 * pixel + c] - b.rgb[3 * pixel + c]));
    strong += most > 8 ? 1u : 0u;
  }
  return {rmsDifference(a, b), 1e6 * static_cast<double>(strong) / (static_cast<double>(a.rgb.size()) / 3)};
}

TEST_P(MorphTest, FourFullyMorphedChildrenLookLikeTheirParent) {
  for (const bool baseline : {false, true}) {
    auto renderer = makeRenderer(moonSunlight(), {.forceBaseline = baseline});
    for (const int level : {1, 5, 12, 20}) {
      const TilePointer parent = tiles().tile(tileAt(GetParam(), glm::dvec3(0.9, 0.02, 0.01), level));
      renderer->upload(parent);
      std::vector<DrawnTile> morphed, own;
      for (int digit = 0; digit < 4; ++digit) {
        const FacePath child = parent->metadata.path.child(digit);
        renderer->upload(tiles().tile(child));
        morphed.push_back({child, morphedBy(1)});
        own.push_back({child, {}});
      }
      const Camera camera = cameraOver(*parent, level < 3 ? 2.0 : 0.7);
      for (const Placement placement : {Placement::Integer, Placement::DoubleFloat, Placement::Cpu}) {
        const Image alone = picture(*renderer, camera, {{parent->metadata.path, {}}}, placement);
        const PictureDifference same = compare(alone, picture(*renderer, camera, morphed, placement)),
                                control = compare(alone, picture(*renderer, camera, own, placement));
        std::printf("level %2d, %s%s: RMS %.4f of 255, %.1f of 10^6 pixels; control: RMS %.3f, %.0f\n", level,
                    std::string(placementName(placement)).c_str(), baseline ? ", baseline" : "", same.rms,
                    same.strongPerMillion, control.rms, control.strongPerMillion);
        EXPECT_LE(same.rms, 1.0);
        EXPECT_LE(same.strongPerMillion, 10.0);
        EXPECT_GT(control.rms, 1.0) << "the control: children as they are";
      }
    }
  }
}

TEST_P(MorphTest, WhatCannotMorphIsDrawnAsItIsAndWithItsSkirts) {
  auto renderer = makeRenderer();
  const TilePointer child = tiles().tile(tileAt(GetParam(), glm::dvec3(-0.8, 0.1, 0.3), 6));
  const FacePath path = child->metadata.path;
  const Camera camera = cameraOver(*child, 1);
  auto target = RenderTarget::create(kWidth, kHeight);
  ASSERT_TRUE(target);
  target->bind();
  const auto triangles = [&](const TileMorph& morph, const DrawSettings& settings = {}) {
    return renderer->draw(camera, std::vector<DrawnTile>{{path, morph}}, settings).triangles;
  };
  const std::size_t surface = (GetParam() == Scheme::Cube ? 2 : 1) * kCells * kCells,
                    skirts = 2 * kCells * static_cast<std::size_t>(edgeCount(GetParam()));
  TileMorph stitched = morphedBy(0.5f);
  stitched.coarserEdges = 0b0101;
  renderer->upload(child);
  EXPECT_EQ(triangles({}), surface);
  EXPECT_EQ(triangles({}, {.skirts = true}), surface + skirts);
  EXPECT_EQ(triangles(stitched), surface + skirts) << "its parent is not there";
  const auto own = renderer->clipPositions(camera, {path, {}}, Placement::Integer);
  EXPECT_EQ(renderer->clipPositions(camera, {path, stitched}, Placement::Integer), own);
  renderer->upload(tiles().tile(path.parent()));
  EXPECT_EQ(triangles(stitched), surface - kCells);
  EXPECT_NE(renderer->clipPositions(camera, {path, stitched}, Placement::Integer), own);

  Tile holed = *child;
  holed.mesh.triangles.erase(holed.mesh.triangles.begin(), holed.mesh.triangles.begin() + 3);
  renderer->upload(std::make_shared<const Tile>(holed));
  EXPECT_EQ(triangles({}), surface + skirts - 1) << "no grid: its own triangles";
  EXPECT_EQ(triangles(stitched), surface + skirts - 1);

  const FacePath face = FacePath::wholeFace(GetParam(), 1);
  renderer->upload(tiles().tile(face));
  EXPECT_EQ(renderer->draw(camera, std::vector<DrawnTile>{{face, stitched}}, {}).triangles, surface)
      << "a whole face has no parent";
  RenderTarget::bindWindow();
}

TEST_P(MorphTest, TilesThatCameOverTheWireLieInGridOrderToo) {
  auto renderer = makeRenderer();
  const FacePath path = tileAt(GetParam(), glm::dvec3(0.3, -0.2, 0.9), 9);
  const TilePointer tile = built(path);
  const Camera camera = cameraOver(*tile, 1);
  renderer->upload(tile);
  const auto asBuilt = renderer->clipPositions(camera, {path, {}}, Placement::Integer);
  const auto decoded = std::make_shared<const Tile>(decodeTile(tiles().builder().build(path).value().glb).value());
  ASSERT_NE(decoded->mesh.gridIndices, tile->mesh.gridIndices) << "Draco has an order of its own";
  renderer->upload(decoded);
  EXPECT_EQ(renderer->clipPositions(camera, {path, {}}, Placement::Integer), asBuilt);
}

INSTANTIATE_TEST_SUITE_P(Schemes, MorphTest, test::bothSchemes(), test::nameOfScheme);

}  // namespace
}  // namespace terrane

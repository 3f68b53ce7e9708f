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
#include "proto/gltf_tile.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/parent_tiles.h"
#include "tests/capture/stitched_tiles.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr int kCells = 64, kSide = kCells + 1;
constexpr std::uint64_t kSeed = 20261126;
using TilePointer = std::shared_ptr<const Tile>;

class MorphTest : public GlTest {
 protected:
  static TilePointer built(const FacePath& path) {
    return std::make_shared<const Tile>(moon().builder().buildMesh(path).value());
  }
  /// Above the tile's middle by so many of its widths.
  static Camera cameraOver(const Tile& tile, double widths) {
    const glm::dvec3 at = tile.metadata.sphere.center;
    const double width = nominalTileWidthMeters(moon().selection().radiusMeters, tile.metadata.path.level());
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

TEST_F(MorphTest, EveryVertexMovesToAPointOfTheParentsMesh) {
  std::mt19937_64 random(kSeed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  std::size_t moved = 0, compared = 0;
  for (int round = 0; round < kParentLevels; ++round) {
    const TilePointer parent = built(parentOf(random, round));
    for (int digit = 0; digit < 4; ++digit) {
      const TilePointer child = built(parent->metadata.path.child(digit));
      const auto grid = morphGrid(child->metadata, parent->metadata);
      ASSERT_TRUE(grid);
      for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i, ++compared) {
          const ParentVertices to = grid->parentVertices(i, j);
          LatticePoint target = child->metadata.origin + LatticePoint(grid->parentMinusOwn);
          for (const int vertex : {to.first, to.second})
            target += latticePoint(*parent, vertex % kSide, vertex / kSide) - parent->metadata.origin;
          ASSERT_EQ(target, twiceMeshPoint(*parent, 2 * grid->firstColumn + i, 2 * grid->firstRow + j))
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
  EXPECT_EQ(morphGrid(tile, parent)->firstColumn, 32);
  EXPECT_EQ(morphGrid(tile, parent)->firstRow, 32);
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

TEST_F(MorphTest, AVertexThatDoesNotMorphKeepsItsBitsInATileThatDoes) {
  auto renderer = makeRenderer();
  const TilePointer child = moon().tile(FacePath::cubeTile(3, 11, 700, 701));
  renderer->upload(child);
  renderer->upload(moon().tile(child->metadata.path.parent()));
  const Camera camera = cameraOver(*child, 0.1);
  for (const Placement placement : {Placement::Integer, Placement::DoubleFloat, Placement::Cpu, Placement::Float32}) {
    TileMorph corner;
    corner.sides[static_cast<std::size_t>(Side::UMaxVMax)] = 0.5f;
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

TEST_F(MorphTest, FourFullyMorphedChildrenLookLikeTheirParent) {
  for (const bool baseline : {false, true}) {
    auto renderer = makeRenderer(moonSunlight(), {.forceBaseline = baseline});
    for (const int level : {1, 5, 12, 20}) {
      const auto line = (std::uint32_t{1} << level) / 2;
      const TilePointer parent = moon().tile(FacePath::cubeTile(0, level, line, line));
      renderer->upload(parent);
      std::vector<DrawnTile> morphed, own;
      for (int digit = 0; digit < 4; ++digit) {
        const FacePath child = parent->metadata.path.child(digit);
        renderer->upload(moon().tile(child));
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

TEST_F(MorphTest, WhatCannotMorphIsDrawnAsItIsAndWithItsSkirts) {
  auto renderer = makeRenderer();
  const TilePointer child = moon().tile(FacePath::cubeTile(1, 6, 20, 33));
  const FacePath path = child->metadata.path;
  const Camera camera = cameraOver(*child, 1);
  auto target = RenderTarget::create(kWidth, kHeight);
  ASSERT_TRUE(target);
  target->bind();
  const auto triangles = [&](const TileMorph& morph, const DrawSettings& settings = {}) {
    return renderer->draw(camera, std::vector<DrawnTile>{{path, morph}}, settings).triangles;
  };
  constexpr std::size_t kSurface = 2 * kCells * kCells, kSkirts = 8 * kCells;
  TileMorph stitched = morphedBy(0.5f);
  stitched.coarserEdges = 0b0101;
  renderer->upload(child);
  EXPECT_EQ(triangles({}), kSurface);
  EXPECT_EQ(triangles({}, {.skirts = true}), kSurface + kSkirts);
  EXPECT_EQ(triangles(stitched), kSurface + kSkirts) << "its parent is not there";
  const auto own = renderer->clipPositions(camera, {path, {}}, Placement::Integer);
  EXPECT_EQ(renderer->clipPositions(camera, {path, stitched}, Placement::Integer), own);
  renderer->upload(moon().tile(path.parent()));
  EXPECT_EQ(triangles(stitched), kSurface - kCells);
  EXPECT_NE(renderer->clipPositions(camera, {path, stitched}, Placement::Integer), own);

  Tile holed = *child;
  holed.mesh.triangles.erase(holed.mesh.triangles.begin(), holed.mesh.triangles.begin() + 3);
  renderer->upload(std::make_shared<const Tile>(holed));
  EXPECT_EQ(triangles({}), kSurface + kSkirts - 1) << "no grid: its own triangles";
  EXPECT_EQ(triangles(stitched), kSurface + kSkirts - 1);

  const FacePath face = FacePath::wholeFace(Scheme::Cube, 1);
  renderer->upload(moon().tile(face));
  EXPECT_EQ(renderer->draw(camera, std::vector<DrawnTile>{{face, stitched}}, {}).triangles, kSurface)
      << "a whole face has no parent";
  RenderTarget::bindWindow();
}

TEST_F(MorphTest, TilesThatCameOverTheWireLieInGridOrderToo) {
  auto renderer = makeRenderer();
  const FacePath path = FacePath::cubeTile(4, 9, 100, 300);
  const TilePointer tile = built(path);
  const Camera camera = cameraOver(*tile, 1);
  renderer->upload(tile);
  const auto asBuilt = renderer->clipPositions(camera, {path, {}}, Placement::Integer);
  const auto decoded = std::make_shared<const Tile>(decodeTile(moon().builder().build(path).value().glb).value());
  ASSERT_NE(decoded->mesh.gridIndices, tile->mesh.gridIndices) << "Draco has an order of its own";
  renderer->upload(decoded);
  EXPECT_EQ(renderer->clipPositions(camera, {path, {}}, Placement::Integer), asBuilt);
}

}  // namespace
}  // namespace terrane

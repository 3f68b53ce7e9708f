// Fully morphed children against their parents, vertex by vertex, as the shaders compute them: places, colours and
// light.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <set>
#include <span>

#include "client/render/morph_grid.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/parent_tiles.h"
#include "tests/capture/stitched_tiles.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr int kCells = 64;
constexpr std::uint64_t kSeed = 20261126;
constexpr std::array kExactPlacements{Placement::Integer, Placement::DoubleFloat, Placement::Cpu};
using TilePointer = std::shared_ptr<const Tile>;

/// What a few roundings make of an odd vertex' place, in units of 2^-24 of its distance, and of its light and colours,
/// all below 2: a thousandth of a display's step, though light divides by sines of grazing angles.
constexpr double kPositionBound = 16, kShadingBound = 0x1p-18;

/// Of four floats a vertex.
struct Differences {
  std::size_t even = 0, evenDiffering = 0, odd = 0;
  double worst = 0;  ///< of odd vertices, in the unit of what is compared
};

std::size_t childrenToCompare() {
  const char* value = std::getenv("TERRANE_MORPH_TILES");  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? 200 : std::strtoull(value, nullptr, 10);
}

TilePointer built(const TileBuilder& builder, const FacePath& path) {
  return std::make_shared<const Tile>(builder.buildMesh(path).value());
}

/// Above the tile's middle by so many of its widths.
Camera cameraOver(const Tile& tile, double bodyRadius, double widths) {
  const glm::dvec3 at = tile.metadata.sphere.center;
  const double width = nominalTileWidthMeters(bodyRadius, tile.metadata.path.level(), tile.metadata.path.scheme());
  const ViewPose pose{std::atan2(at.y, at.x), std::asin(at.z / glm::length(at)),
                      tile.metadata.heights.maxMeters + widths * width, 0.3, -80 * kDegree};
  return cameraFromPose(pose, bodyRadius, 0.9, kWidth, kHeight);
}

/// Calls odd(i, j, vertex, parent's two) where no vertex of the parent's lies, and compares bits elsewhere.
template <class Odd>
void compareVertices(const MorphGrid& grid, std::span<const float> own, std::span<const float> parents,
                     Differences& found, const Odd& odd) {
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= grid.grid.rowEnd(j); ++i) {
      const ParentVertices to = grid.parentVertices({i, j});
      const auto vertex = own.subspan(4 * static_cast<std::size_t>(grid.grid.index({i, j})), 4),
                 first = parents.subspan(4 * static_cast<std::size_t>(to.first), 4),
                 second = parents.subspan(4 * static_cast<std::size_t>(to.second), 4);
      if (to.first != to.second) {
        ++found.odd;
        found.worst = std::max(found.worst, odd(i, j, vertex, first, second));
        continue;
      }
      ++found.even;
      for (std::size_t c = 0; c < 4; ++c) {
        if (std::bit_cast<std::uint32_t>(vertex[c]) == std::bit_cast<std::uint32_t>(first[c])) continue;
        ++found.evenDiffering;
        break;
      }
    }
  }
}

/// A child between its parent and itself, as one camera sees it.
class MorphToParent : public GlTestOfSchemes {
 protected:
  struct Pair {
    TileRenderer& renderer;
    Camera camera;
    TilePointer child, parent;
    MorphGrid grid;
    Placement placement;
  };
  struct Found {
    Differences positions, shading, control;
  };

  /// In units of 2^-24 of the distance, from the exact middle of the parent's edge. A pair of floats holds the camera
  /// itself no better than to 2^-48 of its distance from the body's centre.
  static void comparePositions(const Pair& pair, Differences& found) {
    const auto own =
                   pair.renderer.clipPositions(pair.camera, {pair.child->metadata.path, morphedBy(1)}, pair.placement),
               parents = pair.renderer.clipPositions(pair.camera, {pair.parent->metadata.path, {}}, pair.placement);
    const glm::dmat4 projection = reversedInfiniteProjection(pair.camera);
    const double step = stepMeters(pair.child->metadata.stepExponent);
    const double camera =
        pair.placement == Placement::DoubleFloat ? glm::length(pair.camera.positionBody) * 0x1p-24 : 0;
    compareVertices(pair.grid, own, parents, found, [&](int i, int j, std::span<const float> vertex, auto, auto) {
      const glm::ivec2 at = pair.grid.firstInHalfCells() + pair.grid.direction() * glm::ivec2(i, j);
      const LatticePoint target = twiceMeshPoint(*pair.parent, at.x, at.y);
      const glm::dvec3 relative = glm::dvec3(target) * step - pair.camera.positionBody;
      const double distance = glm::length(relative) + camera + 1000 * step;  // and the way that it moved
      const glm::dvec3 clip(projection[0][0] * glm::dot(pair.camera.right, relative),
                            projection[1][1] * glm::dot(pair.camera.up, relative),
                            -glm::dot(pair.camera.backward, relative));
      return glm::length(glm::dvec3(vertex[0], vertex[1], vertex[3]) - clip) / (distance * 0x1p-24);
    });
  }

  /// Against the middle of what the parent's own draw interpolates between.
  static void compareShading(const Pair& pair, float morph, Differences& found) {
    const auto own = pair.renderer.colorsAndLight(pair.camera, {pair.child->metadata.path, morphedBy(morph)},
                                                  pair.placement),
               parents = pair.renderer.colorsAndLight(pair.camera, {pair.parent->metadata.path, {}}, pair.placement);
    compareVertices(
        pair.grid, own, parents, found,
        [](int, int, std::span<const float> vertex, std::span<const float> first, std::span<const float> second) {
          double worst = 0;
          for (std::size_t c = 0; c < 4; ++c) {
            const double middle = 0.5 * (static_cast<double>(first[c]) + static_cast<double>(second[c]));
            worst = std::max(worst, std::fabs(static_cast<double>(vertex[c]) - middle));
          }
          return worst;
        });
  }
};

TEST_P(MorphToParent, GivesItsBits) {
  std::mt19937_64 random(kSeed);
  std::printf("seed %llu, %zu children\n", static_cast<unsigned long long>(kSeed), childrenToCompare());
  auto renderer = makeRenderer(moonSunlight());
  std::array<Found, kExactPlacements.size()> found;
  std::set<int> levels, faces;
  for (std::size_t round = 0; 4 * round < childrenToCompare(); ++round) {
    const TilePointer parent = built(tiles().builder(), parentOf(GetParam(), random, static_cast<int>(round)));
    const double widths = std::ldexp(1.0, static_cast<int>(random() % 8) - 5);
    const Camera camera = cameraOver(*parent, tiles().selection().radiusMeters, widths);
    renderer->clear();
    renderer->upload(parent);
    for (int digit = 0; digit < 4; ++digit) {
      const TilePointer child = built(tiles().builder(), parent->metadata.path.child(digit));
      levels.insert(child->metadata.path.level());
      faces.insert(child->metadata.path.face());
      renderer->upload(child);
      const auto grid = morphGrid(child->metadata, parent->metadata);
      ASSERT_TRUE(grid);
      for (std::size_t i = 0; i < kExactPlacements.size(); ++i) {
        const Pair pair{*renderer, camera, child, parent, *grid, kExactPlacements[i]};
        comparePositions(pair, found[i].positions);
        compareShading(pair, 1, found[i].shading);
        compareShading(pair, 0, found[i].control);
      }
    }
  }
  const auto levelCount = static_cast<std::size_t>(parentLevels(GetParam()));
  if (childrenToCompare() >= 4 * levelCount) {
    EXPECT_EQ(levels.size(), levelCount);
    EXPECT_EQ(faces.size(), static_cast<std::size_t>(faceCount(GetParam())));
  }
  for (std::size_t i = 0; i < kExactPlacements.size(); ++i) {
    const std::string name(placementName(kExactPlacements[i]));
    const auto& [positions, shading, control] = found[i];
    std::printf("%s: %zu of %zu even vertices differ; %zu odd ones off by at most %.2f u\n", name.c_str(),
                positions.evenDiffering, positions.even, positions.odd, positions.worst);
    std::printf("  colours and light: %zu even ones differ; odd ones by at most %.3g; control: %zu, %.3g\n",
                shading.evenDiffering, shading.worst, control.evenDiffering, control.worst);
    EXPECT_EQ(positions.evenDiffering, 0u) << name;
    EXPECT_LE(positions.worst, kPositionBound) << name;
    EXPECT_GT(positions.odd, 2 * positions.even);
    EXPECT_EQ(shading.evenDiffering, 0u) << name;
    EXPECT_LE(shading.worst, kShadingBound) << name;
    EXPECT_GT(control.evenDiffering, control.even / 2) << name << ": the control, with its own normals and colours";
    EXPECT_GT(control.worst, 1000 * kShadingBound) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, MorphToParent, test::bothSchemes(), test::nameOfScheme);

}  // namespace
}  // namespace terrane

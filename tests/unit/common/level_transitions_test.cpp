// Flights over a moon whose tiles come late: at every vertex that several drawn tiles share they agree on where it is,
// and no change of the drawn set moves a vertex. "Where" is the level whose surface it lies on, a whole number or in
// between, which is what morphs interpolate.
#include "common/view/level_transitions.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <unordered_map>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/triangle_tile.h"
#include "common/view/tile_selection.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

constexpr double kMoon = kMoonRadiusMeters;
constexpr double kPi = std::numbers::pi;
constexpr HeightRange kHeights{-3000, 3000};

SelectionBody moon(Scheme scheme) { return selectionMoon(20, kHeights, scheme); }

HeightRange heightsOf(const FacePath& path) {
  const double reach = std::min(3000.0, 0.05 * nominalTileWidthMeters(kMoon, path.level(), path.scheme()));
  return {-reach, reach};
}

/// A client on a slow line: so many tiles a frame come, coarsest first.
class LateTiles {
 public:
  explicit LateTiles(Scheme scheme) {
    for (int face = 0; face < faceCount(scheme); ++face) add(FacePath::wholeFace(scheme, face));
  }
  void add(const FacePath& path) { tiles_[path] = ResidentTile{heightsOf(path), heightsOf(path)}; }
  /// What is in the picture before what lies beside it, as the viewer asks.
  void load(const TileSelection& picture, const TileSelection& beside, int count) {
    for (const auto* wanted : {&picture.wanted, &beside.wanted})
      for (const WantedTile& tile : *wanted) {
        if (tiles_.contains(tile.path)) continue;
        if (count-- == 0) return;
        add(tile.path);
      }
  }
  ResidentLookup lookup() const {
    return [this](const FacePath& path) {
      const auto found = tiles_.find(path);
      return found == tiles_.end() ? nullptr : &found->second;
    };
  }
  bool canMorph(const FacePath& path) const {
    return path.level() > 0 && tiles_.contains(path) && tiles_.contains(path.parent());
  }

 private:
  std::unordered_map<FacePath, ResidentTile> tiles_;
};

/// A few vertices of a tile: its corners, the middles of its edges, its middle; where each is, and how far out that is
/// in levels.
using Place = std::array<std::int64_t, 3>;
constexpr int kGridLevels = 2, kGrid = 1 << kGridLevels;  // vertices 0 .. 4 along an edge

/// Tiles that share a vertex have the same direction for it, to the bit.
Place placeOf(const glm::dvec3& direction) {
  return {std::bit_cast<std::int64_t>(direction.x), std::bit_cast<std::int64_t>(direction.y),
          std::bit_cast<std::int64_t>(direction.z)};
}
glm::dvec3 directionOf(const Place& place) {
  return {std::bit_cast<double>(place[0]), std::bit_cast<double>(place[1]), std::bit_cast<double>(place[2])};
}

/// A vertex, how far it is drawn towards the parent's, and whether it is drawn at all.
struct Vertex {
  Place place;
  double morph;
  bool drawn;
};

bool isCoarser(const TileMorph& morph, int edge) { return ((morph.coarserEdges >> edge) & 1) != 0; }
double sideOf(const TileMorph& morph, int side) {
  return static_cast<double>(morph.sides[static_cast<std::size_t>(side)]);
}

Vertex squareVertex(const DrawnTile& tile, int i, int j) {
  const FacePath& path = tile.path;
  const glm::dvec3 direction = cubeGridDirection(path.face(), path.level() + kGridLevels,
                                                 std::uint64_t{path.column()} * kGrid + static_cast<unsigned>(i),
                                                 std::uint64_t{path.row()} * kGrid + static_cast<unsigned>(j));
  // The odd vertices of an edge beside a coarser tile are not drawn.
  bool drawn = true;
  const auto along = [&](bool isOn, Side edge, int k) {
    drawn = drawn && !(isOn && k % 2 == 1 && isCoarser(tile.morph, static_cast<int>(edge)));
  };
  along(i == 0, Side::UMin, j);
  along(i == kGrid, Side::UMax, j);
  along(j == 0, Side::VMin, i);
  along(j == kGrid, Side::VMax, i);
  const TileGrid grid{path.scheme(), kGrid};
  const float morph = morphByBorders(grid, tile.morph)[grid.borders({i, j})];
  return {placeOf(direction), static_cast<double>(morph), drawn};
}

Vertex triangleVertex(const DrawnTile& tile, int i, int j) {
  const FaceWeights weights = gridVertexWeights(triangleTile(tile.path), kGrid, {i, j});
  const glm::dvec3 direction = icoGridDirection(kIcoMap, tile.path.face(), tile.path.level() + kGridLevels, weights);
  const std::array<int, 3> towards{kGrid - i - j, i, j};  // each corner
  Vertex vertex{placeOf(direction), static_cast<double>(tile.morph.own), true};
  for (int k = 0; k < 3; ++k) {
    const auto next = static_cast<std::size_t>((k + 1) % 3);
    if (towards[static_cast<std::size_t>(k)] == 0) {  // on the edge opposite corner k
      vertex.morph = sideOf(tile.morph, k);
      if (towards[next] % 2 == 1 && isCoarser(tile.morph, k)) vertex.drawn = false;
    }
  }
  for (int k = 0; k < 3; ++k)
    if (towards[static_cast<std::size_t>(k)] == kGrid) vertex.morph = sideOf(tile.morph, kMostEdges + k);
  return vertex;
}

/// The level of every vertex that is drawn; NaN where two tiles do not agree.
std::map<Place, double> levelsOf(const std::vector<DrawnTile>& drawn) {
  std::map<Place, double> levels;
  for (const DrawnTile& tile : drawn) {
    const bool square = tile.path.scheme() == Scheme::Cube;
    for (int j = 0; j <= kGrid; ++j) {
      for (int i = 0; i <= (square ? kGrid : kGrid - j); ++i) {
        const Vertex vertex = square ? squareVertex(tile, i, j) : triangleVertex(tile, i, j);
        if (!vertex.drawn) continue;
        const double level = tile.path.level() - vertex.morph;
        const auto [at, isNew] = levels.try_emplace(vertex.place, level);
        if (!isNew && at->second != level) at->second = std::nan("");
      }
    }
  }
  return levels;
}

std::size_t disagreements(const std::vector<DrawnTile>& drawn) {
  std::size_t count = 0;
  for (const auto& [place, level] : levelsOf(drawn)) count += std::isnan(level) ? 1u : 0u;
  return count;
}

bool isInView(const Place& place, const Camera& camera) {
  const glm::dvec3 ground = directionOf(place) * kMoon;
  const glm::dvec3 away = ground - camera.positionBody;
  const double ahead = -glm::dot(away, camera.backward), reach = 0.5 * camera.heightPixels / pixelsPerRadian(camera);
  return ahead > 0 && std::fabs(glm::dot(away, camera.up)) < reach * ahead &&
         std::fabs(glm::dot(away, camera.right)) < reach * ahead * camera.widthPixels / camera.heightPixels &&
         glm::dot(away, ground) < 0;
}

/// Vertices in view drawn before and after whose level is not the same.
std::size_t moved(const Camera& camera, const std::vector<DrawnTile>& before, const std::vector<DrawnTile>& after) {
  const auto old = levelsOf(before);
  std::size_t count = 0;
  for (const auto& [place, level] : levelsOf(after)) {
    const auto found = old.find(place);
    count += found != old.end() && found->second != level && isInView(place, camera) ? 1u : 0u;
  }
  return count;
}

ViewPose descentPose(double t) {
  return {0.3 + 0.02 * t, 0.2, 3e6 * std::pow(200.0 / 3e6, t), 0.5, -kPi / 2 + 1.1 * t};
}
ViewPose groundPose(double t) { return {0.3 + 3e-3 * std::sin(6 * t), 0.2 + 2e-3 * t, 300 + 200 * t, 6 * t, -0.35}; }

struct FlightResult {
  TransitionCounts counts;
  std::size_t moved = 0, movedFrames = 0, disagreements = 0;
  bool settled = false;
};

FlightResult fly(Scheme scheme, ViewPose (*pose)(double), int frames, int tilesPerFrame, bool morph) {
  const SelectionBody body = moon(scheme);
  LateTiles tiles(scheme);
  LevelTransitions transitions({.secondsPerLevel = 0.3, .morph = morph});
  const auto canMorph = [&](const FacePath& path) { return tiles.canMorph(path); };
  FlightResult result;
  std::vector<DrawnTile> drawn;
  for (int frame = 0; frame < frames + 400; ++frame) {
    const double t = std::min(1.0, frame / static_cast<double>(frames));
    const Camera camera = cameraFromPose(pose(t), kMoon, 0.9, 640, 360);
    const TileSelection selection = selectTiles(camera, body, tiles.lookup(), {});
    const auto mayBeSeen = [&](const FacePath& path) { return tileMayBeSeen(path, camera, body, tiles.lookup()); };
    // Changes of the set alone: no time passes.
    const std::vector<DrawnTile> changed = transitions.advance(selection.draw, 0, canMorph, mayBeSeen);
    const std::size_t jumped = moved(camera, drawn, changed);
    result.moved += jumped;
    result.movedFrames += jumped > 0 ? 1u : 0u;
    drawn = transitions.advance(selection.draw, 1.0 / 30, canMorph, mayBeSeen);
    result.disagreements += disagreements(changed) + disagreements(drawn);
    tiles.load(selection, selectTiles(widened(camera, kShareAhead), body, tiles.lookup(), {}), tilesPerFrame);
    if (frame >= frames && selection.complete && transitions.settled()) {
      result.settled = true;
      break;
    }
  }
  result.counts = transitions.counts();
  return result;
}

void print(const char* name, const FlightResult& result) {
  std::cout << name << ": " << result.counts.splits << " splits, " << result.counts.merges << " merges, "
            << result.counts.entered << " entered, " << result.counts.hurried << " hurried, " << result.counts.jumps
            << " jumps; " << result.moved << " vertices moved in " << result.movedFrames << " frames, "
            << result.disagreements << " disagreements\n";
}

class LevelTransitionsFlight : public testing::TestWithParam<std::tuple<Scheme, ViewPose (*)(double), int>> {};

TEST_P(LevelTransitionsFlight, IsClosedAndMovesNoVertexWhenTheDrawnSetChanges) {
  const auto [scheme, pose, tilesPerFrame] = GetParam();
  const FlightResult result = fly(scheme, pose, 240, tilesPerFrame, true);
  const FlightResult control = fly(scheme, pose, 240, tilesPerFrame, false);
  print("morph", result);
  print("control, without", control);
  EXPECT_TRUE(result.settled);
  EXPECT_EQ(result.disagreements, 0u);
  EXPECT_EQ(result.counts.jumps, 0u);
  // Where a coarse tile comes in beside finer ones vertices may move in the very rim of the view; how little of that is
  // seen the pop meter says.
  EXPECT_LE(result.moved, control.moved / 10);
  EXPECT_LE(result.movedFrames, 8u);
  EXPECT_GT(result.counts.splits, 20u);
  EXPECT_GT(control.moved, 300u);
  EXPECT_EQ(control.disagreements, 0u);
}

TEST(LevelTransitions, WhatComesIntoViewOfATileThatItsChildrenStillDrawIsDrawnAtOnce) {
  const FacePath tile = FacePath::wholeFace(Scheme::Cube, 2).child(1).child(3);
  const std::vector<FacePath> two{tile.child(0), tile.child(1)}, whole{tile};
  const auto never = [](const FacePath&) { return false; };
  const auto always = [](const FacePath&) { return true; };
  const auto drawnAfter = [&](const LevelTransitions::Question& canMorph, const LevelTransitions::Question& mayBeSeen) {
    LevelTransitions transitions;
    transitions.advance(two, 0, always, never);
    std::set<FacePath> paths;
    for (const DrawnTile& drawn : transitions.advance(whole, 0, canMorph, mayBeSeen)) paths.insert(drawn.path);
    return paths;
  };
  EXPECT_EQ(drawnAfter(always, always), (std::set{tile.child(0), tile.child(1), tile.child(2), tile.child(3)}));
  EXPECT_EQ(drawnAfter(never, always), std::set{tile}) << "children that are not there: the tile itself, at once";
  EXPECT_EQ(drawnAfter(always, never), (std::set{tile.child(0), tile.child(1)})) << "nobody sees the others";
}

INSTANTIATE_TEST_SUITE_P(Flights, LevelTransitionsFlight,
                         testing::Combine(testing::Values(Scheme::Cube, Scheme::Ico),
                                          testing::Values(descentPose, groundPose), testing::Values(2, 1000)));

}  // namespace
}  // namespace terrane

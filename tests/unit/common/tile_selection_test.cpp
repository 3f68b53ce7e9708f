#include "common/view/tile_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_neighbours.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

constexpr double kMoon = kMoonRadiusMeters;
constexpr double kPi = std::numbers::pi;
constexpr unsigned kSeed = 2;
constexpr HeightRange kHeights{-9000, 9000};

/// Of either scheme.
class TileSelectionOf : public testing::TestWithParam<Scheme> {
 protected:
  static SelectionBody moon(int deepest = 24) { return selectionMoon(deepest, kHeights, GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Schemes, TileSelectionOf, testing::Values(Scheme::Cube, Scheme::Ico),
                         [](const auto& scheme) { return std::string(schemeName(scheme.param)); });

SelectionBody moon(int deepest = 24) { return selectionMoon(deepest, kHeights); }

/// The true ground of these tests: a smooth swell, so that heights tighten with the level as a real body's do.
HeightRange heightsOf(const FacePath& path, double reachPerWidth) {
  const double width = nominalTileWidthMeters(kMoon, path.level(), path.scheme());
  const auto part = static_cast<double>(path.ancestor(std::min(path.level(), 3)).packedDigits());
  const double middle = 2000 * std::sin(0.7 * path.face() + 3.0 * part);
  const double reach = std::min(7000.0, reachPerWidth * width);
  return {middle - reach, middle + reach};
}
HeightRange ownHeightsOf(const FacePath& path) { return heightsOf(path, 0.05); }
HeightRange subtreeHeightsOf(const FacePath& path) { return heightsOf(path, 0.2); }

/// Tiles that are there. A tile's parent is always there too, as the client keeps it.
class Residents {
 public:
  void add(const FacePath& path) {
    for (int level = 0; level <= path.level(); ++level) {
      const FacePath ancestor = path.ancestor(level);
      tiles_[ancestor] = ResidentTile{subtreeHeightsOf(ancestor), ownHeightsOf(ancestor)};
    }
  }
  void addRoots(Scheme scheme) {
    for (int face = 0; face < faceCount(scheme); ++face) add(FacePath::wholeFace(scheme, face));
  }
  ResidentLookup lookup() const {
    return [this](const FacePath& path) {
      const auto found = tiles_.find(path);
      return found == tiles_.end() ? nullptr : &found->second;
    };
  }
  bool has(const FacePath& path) const { return tiles_.contains(path); }

 private:
  std::unordered_map<FacePath, ResidentTile> tiles_;
};

/// Loads what is wanted until nothing more is, as a client on a fast line does.
TileSelection settle(const Camera& camera, const SelectionBody& body, const SelectionSettings& settings,
                     Residents& residents) {
  TileSelection selection;
  for (int round = 0; round < 40; ++round) {
    selection = selectTiles(camera, body, residents.lookup(), settings);
    bool news = false;
    for (const WantedTile& tile : selection.wanted) {
      news = news || !residents.has(tile.path);
      residents.add(tile.path);
    }
    if (!news) break;
  }
  return selection;
}

struct Views {
  std::mt19937_64 random{kSeed};
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Camera camera() {
    const double pitches[] = {-kPi / 2, 0.0, between(-kPi / 2, kPi / 2)};
    const ViewPose pose{between(-kPi, kPi), std::asin(between(-1, 1)), std::pow(10.0, between(3.5, 7)),
                        between(-kPi, kPi), pitches[random() % 3]};
    return cameraFromPose(pose, kMoon, 0.9, 1280, 720);
  }
};

using PathSet = std::unordered_set<FacePath>;

bool hasAncestorIn(const FacePath& path, const PathSet& set, int* steps = nullptr) {
  for (int level = path.level() - 1; level >= 0; --level) {
    if (!set.contains(path.ancestor(level))) continue;
    if (steps != nullptr) *steps = path.level() - level;
    return true;
  }
  return false;
}

void expectDisjointAndBalanced(const std::vector<FacePath>& draw) {
  const PathSet set(draw.begin(), draw.end());
  EXPECT_EQ(set.size(), draw.size());
  for (const FacePath& path : draw) {
    EXPECT_FALSE(hasAncestorIn(path, set)) << path.text() << " lies below another drawn tile";
    for (const FacePath& neighbour : tilesAround(path)) {
      int steps = 0;
      if (hasAncestorIn(neighbour, set, &steps)) {
        EXPECT_LE(steps, 1) << path.text() << " beside a tile " << steps << " levels coarser";
      }
    }
  }
}

TEST_P(TileSelectionOf, DrawsWhatIsWantedOnceAllIsThere) {
  Views views;
  RecordProperty("seed", kSeed);
  for (int i = 0; i < 60; ++i) {
    const Camera camera = views.camera();
    Residents residents;
    const TileSelection selection = settle(camera, moon(), {}, residents);
    EXPECT_TRUE(selection.complete);
    EXPECT_FALSE(selection.rootsMissing);
    PathSet leaves;
    for (const WantedTile& tile : selection.wanted)
      if (tile.leaf) leaves.insert(tile.path);
    EXPECT_EQ(leaves, PathSet(selection.draw.begin(), selection.draw.end()));
  }
}

/// Is a tile beside one of this one's children refined? Then this one had to be, or it would lie two levels above that.
bool touchesARefinedTile(const FacePath& path, const PathSet& refined) {
  for (int digit = 0; digit < 4; ++digit) {
    for (const FacePath& beside : tilesAround(path.child(digit)))
      if (beside.parent() != path && refined.contains(beside)) return true;
  }
  return false;
}

TEST_P(TileSelectionOf, MeetsTheErrorEverywhereItMayRefine) {
  Views views;
  const SelectionBody body = moon(8);
  int forNothing = 0, looked = 0;
  for (int i = 0; i < 60; ++i) {
    Residents residents;
    const std::vector<WantedTile> wanted = settle(views.camera(), body, {}, residents).wanted;
    PathSet refined;
    for (const WantedTile& tile : wanted)
      if (!tile.leaf) refined.insert(tile.path);
    for (const WantedTile& tile : wanted) {
      if (tile.leaf && tile.path.level() < body.maxLevel) {
        EXPECT_LE(tile.screenErrorPixels, 2.0) << tile.path.text();
      }
      ++looked;
      forNothing += !tile.leaf && tile.screenErrorPixels <= 2.0 && !touchesARefinedTile(tile.path, refined) ? 1 : 0;
    }
  }
  // One whose refined neighbour has all of its children out of view, and so is not in the list.
  EXPECT_LE(forNothing, looked / 1000);
}

TEST_P(TileSelectionOf, StaysDisjointAndBalancedWhateverIsResident) {
  Views views;
  RecordProperty("seed", kSeed);
  const SelectionBody body = moon(12);
  int coarserThanWanted = 0;
  for (int i = 0; i < 150; ++i) {
    const Camera camera = views.camera();
    // A tolerance this loose refines towards the camera in steep steps, so that balance has work to do in the wanted
    // set as well.
    const SelectionSettings settings{.errorPixels = i % 3 == 0 ? 40.0 : 2.0};
    Residents all;
    const TileSelection settled = settle(camera, body, settings, all);
    expectDisjointAndBalanced(settled.draw);
    Residents some;
    some.addRoots(GetParam());
    for (const WantedTile& tile : settled.wanted)
      if (views.between(0, 1) < 0.7) some.add(tile.path);
    const TileSelection partial = selectTiles(camera, body, some.lookup(), settings);
    expectDisjointAndBalanced(partial.draw);
    coarserThanWanted += !partial.complete;
    for (const FacePath& path : partial.draw) EXPECT_TRUE(some.has(path));
  }
  EXPECT_GT(coarserThanWanted, 75);
}

TEST_P(TileSelectionOf, LeavesNoHoleWhereRootsAreThere) {
  Views views;
  const SelectionBody body = moon(12);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = views.camera();
    Residents all, some;
    some.addRoots(GetParam());
    for (const WantedTile& tile : settle(camera, body, {}, all).wanted)
      if (views.between(0, 1) < 0.8) some.add(tile.path);
    const TileSelection selection = selectTiles(camera, body, some.lookup(), {});
    EXPECT_FALSE(selection.rootsMissing);
    const PathSet drawn(selection.draw.begin(), selection.draw.end());
    for (const WantedTile& tile : selection.wanted) {
      if (tile.leaf) {
        EXPECT_TRUE(drawn.contains(tile.path) || hasAncestorIn(tile.path, drawn)) << tile.path.text();
      }
    }
  }
}

TEST_P(TileSelectionOf, ATileThatArrivesNeverMakesTheGroundCoarser) {
  Views views;
  const SelectionBody body = moon(12);
  for (int i = 0; i < 40; ++i) {
    const Camera camera = views.camera();
    Residents all, arriving;
    std::vector<FacePath> order;
    for (const WantedTile& tile : settle(camera, body, {}, all).wanted) order.push_back(tile.path);
    std::shuffle(order.begin(), order.end(), views.random);
    // Bounds that do not change with what is known, so that only residency does.
    static const ResidentTile kAny{kHeights};
    const ResidentLookup lookup = [&](const FacePath& path) { return arriving.has(path) ? &kAny : nullptr; };
    arriving.addRoots(GetParam());
    std::vector<FacePath> before = selectTiles(camera, body, lookup, {}).draw;
    for (std::size_t next = 0; next < order.size(); next += 7) {
      for (std::size_t k = next; k < std::min(next + 7, order.size()); ++k) arriving.add(order[k]);
      const std::vector<FacePath> after = selectTiles(camera, body, lookup, {}).draw;
      const PathSet set(after.begin(), after.end());
      for (const FacePath& path : before) EXPECT_FALSE(hasAncestorIn(path, set)) << path.text();
      before = after;
    }
  }
}

TEST_P(TileSelectionOf, IsAPureFunctionOfItsArguments) {
  Views views;
  for (int i = 0; i < 20; ++i) {
    const Camera camera = views.camera();
    Residents residents;
    settle(camera, moon(), {}, residents);
    const TileSelection a = selectTiles(camera, moon(), residents.lookup(), {});
    selectTiles(views.camera(), moon(), residents.lookup(), {});
    const TileSelection b = selectTiles(camera, moon(), residents.lookup(), {});
    EXPECT_EQ(a.draw, b.draw);
    ASSERT_EQ(a.wanted.size(), b.wanted.size());
    for (std::size_t k = 0; k < a.wanted.size(); ++k) EXPECT_EQ(a.wanted[k].path, b.wanted[k].path);
  }
}

TEST_P(TileSelectionOf, AsksForTheCoarsestFirst) {
  Residents residents;
  const TileSelection selection =
      settle(cameraFromPose({0.3, 0.2, 5000, 1, -0.5}, kMoon, 0.9, 1280, 720), moon(), {}, residents);
  EXPECT_TRUE(
      std::is_sorted(selection.wanted.begin(), selection.wanted.end(), [](const WantedTile& a, const WantedTile& b) {
        return a.path.level() < b.path.level() ||
               (a.path.level() == b.path.level() && a.screenErrorPixels > b.screenErrorPixels);
      }));
  EXPECT_EQ(selection.wanted.front().path.level(), 0);
}

TEST(TileSelection, SaysThatAVisibleFaceIsMissing) {
  const Camera camera =
      cameraFromPose({kPi / 4, 0, 3e6, 0, -kPi / 2}, kMoon, 0.9, 1280, 720);  // over the edge of faces 0 and 2
  Residents residents;
  EXPECT_TRUE(selectTiles(camera, moon(), residents.lookup(), {}).rootsMissing);
  EXPECT_TRUE(selectTiles(camera, moon(), residents.lookup(), {}).draw.empty());
  residents.add(FacePath::wholeFace(Scheme::Cube, 0));
  const TileSelection half = selectTiles(camera, moon(), residents.lookup(), {});
  EXPECT_TRUE(half.rootsMissing);
  EXPECT_FALSE(half.complete);
  EXPECT_EQ(half.draw, std::vector<FacePath>{FacePath::wholeFace(Scheme::Cube, 0)});
}

TEST_P(TileSelectionOf, NeverExceedsTheBoundOnTheWork) {
  for (const int bound : {faceCount(GetParam()), 50, 300}) {
    const SelectionSettings settings{.errorPixels = 0.05, .maxTiles = bound};
    Residents residents;
    const TileSelection selection =
        settle(cameraFromPose({0.3, 0.2, 50'000, 1, -0.5}, kMoon, 0.9, 1280, 720), moon(), settings, residents);
    EXPECT_LE(selection.wanted.size(), static_cast<std::size_t>(bound));
    EXPECT_TRUE(selection.complete);
    expectDisjointAndBalanced(selection.draw);
  }
}

TEST_P(TileSelectionOf, LooksAtTheSkyAndWantsNothing) {
  // Over the middle of a face: a whole face's volume reaches far above its edges.
  const bool cube = GetParam() == Scheme::Cube;
  const Camera camera = cameraFromPose(
      {cube ? 0 : kPi / 4, cube ? 0 : std::asin(std::sqrt(1.0 / 3)), 100'000, 0, kPi / 2}, kMoon, 0.9, 1280, 720);
  EXPECT_TRUE(selectTiles(camera, moon(), {}, {}).wanted.empty());
}

TEST(TileSelection, WantsNothingBeyondTheHorizon) {
  const Camera camera = cameraFromPose({0, 0, 10'000, 0, 0}, kMoon, 0.9, 1280, 720);
  Residents with, without;
  const std::size_t culled = settle(camera, moon(), {}, with).wanted.size();
  const std::size_t all = settle(camera, moon(), {.horizonCulling = false}, without).wanted.size();
  EXPECT_LT(culled, all);
  const glm::dvec3 farSide(-1, 0, 0);
  for (const WantedTile& tile : settle(camera, moon(), {}, with).wanted) {
    if (tile.path.level() > 2) {
      EXPECT_NE(tile.path.face(), cubeFaceCoordinates(farSide).face);
    }
  }
}

// (That what a test leaves out is not seen, integration/selection_brute_force_test proves.)
TEST_P(TileSelectionOf, EachTestOnlyLeavesTilesOut) {
  Views views;
  std::size_t leftOut = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera camera = views.camera();
    const SelectionSettings without{.frustumCulling = i % 2 != 0, .horizonCulling = i % 2 == 0};
    Residents residents;
    const std::vector<FacePath> more = settle(camera, moon(), without, residents).draw;
    const std::vector<FacePath> fewer = settle(camera, moon(), {}, residents).draw;
    // A neighbour that is out of view may force a tile finer, never coarser.
    PathSet drawnOrRefined;
    for (const FacePath& path : more)
      for (int level = 0; level <= path.level(); ++level) drawnOrRefined.insert(path.ancestor(level));
    for (const FacePath& path : fewer) EXPECT_TRUE(drawnOrRefined.contains(path)) << path.text();
    EXPECT_LE(fewer.size(), more.size());
    leftOut += more.size() - fewer.size();
  }
  EXPECT_GT(leftOut, 0u);
}

TEST_P(TileSelectionOf, LeavesOutALeafWhoseOwnMeshIsOutOfViewButNotWhatMayHoldFinerGround) {
  // Looking level from 3 km over a body whose proven bounds reach above the camera everywhere, and whose ground lies
  // deep below.
  const Camera camera = cameraFromPose({0, 0, 3000, 0, 0.6}, kMoon, 0.9, 1280, 720);
  const ResidentTile wide{.subtreeHeights = kHeights},
      tight{.subtreeHeights = kHeights, .ownHeights = HeightRange{-8000, -7900}};
  const SelectionBody body = moon(5);
  const auto leaves = [&](const ResidentTile& everyTile) {
    std::size_t count = 0;
    for (const WantedTile& tile : selectTiles(camera, body, [&](const FacePath&) { return &everyTile; }, {}).wanted)
      count += tile.leaf;
    return count;
  };
  EXPECT_GT(leaves(wide), 0u);
  EXPECT_EQ(leaves(tight), 0u);
}

TEST_P(TileSelectionOf, RemembersADroppedTileWithoutAskingForItAgain) {
  Views views;
  for (int i = 0; i < 20; ++i) {
    const Camera camera = views.camera();
    Residents residents;
    const TileSelection settled = settle(camera, moon(), {}, residents);
    PathSet wanted;
    for (const WantedTile& tile : settled.wanted) wanted.insert(tile.path);
    // All that is not wanted is dropped; what is known of it stays.
    std::unordered_map<FacePath, ResidentTile> dropped;
    const ResidentLookup lookup = [&](const FacePath& path) -> const ResidentTile* {
      const ResidentTile* tile = residents.lookup()(path);
      if (tile == nullptr || wanted.contains(path)) return tile;
      ResidentTile memory = *tile;
      memory.drawable = false;
      return &dropped.insert_or_assign(path, memory).first->second;
    };
    const TileSelection after = selectTiles(camera, moon(), lookup, {});
    EXPECT_TRUE(after.complete);
    EXPECT_EQ(after.draw, settled.draw);
    for (const WantedTile& tile : after.wanted) EXPECT_TRUE(wanted.contains(tile.path)) << tile.path.text();
  }
}

TEST_P(TileSelectionOf, AsksAheadForAFewLevelsButNotForTheWholePlanet) {
  const Camera camera = cameraFromPose({0.3, 0.2, 2, 1, -0.3}, kMoon, 0.9, 1280, 720);
  Residents residents;
  int rounds = 0;
  for (bool news = true; news; ++rounds) {
    news = false;
    const TileSelection selection = selectTiles(camera, moon(), residents.lookup(), {});
    EXPECT_LT(selection.wanted.size(), 1500u);
    for (const WantedTile& tile : selection.wanted) {
      news = news || !residents.has(tile.path);
      residents.add(tile.path);
    }
  }
  EXPECT_LT(rounds, 15);  // of 24 levels
}

}  // namespace
}  // namespace terrane

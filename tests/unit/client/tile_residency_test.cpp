#include "client/tiles/tile_residency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/tiling/cube_sphere.h"
#include "tests/unit/client/small_world.h"

namespace terrane {
namespace {

using namespace terrane::testing;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t kGpuBytes = 10'000;

/// A residency without budget or grace, so that evictAll means what it says, and a clock of calls.
class SmallResidency {
 public:
  explicit SmallResidency(std::size_t rememberedTiles = kRememberedTiles) : residency(rememberedTiles) {
    residency.setRevision(kRevision);
  }

  void add(std::string_view tile, double heightMeters = 0, const std::string& revision = kRevision) {
    Tile made = smallTile(path(tile), [&](const glm::dvec3&) { return heightMeters; });
    made.metadata.heights = {heightMeters - 1, heightMeters + 1};
    made.metadata.subtreeHeights = {heightMeters - 10, heightMeters + 10};
    const ResidentTile info{made.metadata.subtreeHeights, made.metadata.heights};
    residency.add(std::make_shared<const Tile>(std::move(made)), info, revision, kGpuBytes, LastWanted{++call_, {}});
  }
  std::vector<FacePath> evictAll() {
    return residency.evict(0, {}, [](const FacePath&, const LastWanted&) { return false; });
  }
  const ResidentTile* find(std::string_view tile) const { return residency.find(path(tile)); }

  TileResidency residency;

 private:
  std::uint64_t call_ = 0;
};

TEST(TileResidency, RemembersTheHeightsOfAnEvictedTileThoughItCannotBeDrawn) {
  SmallResidency small;
  small.add("cube/2/03", 1234);
  ASSERT_TRUE(small.find("cube/2/03"));
  EXPECT_TRUE(small.find("cube/2/03")->drawable);

  EXPECT_THAT(small.evictAll(), ElementsAre(path("cube/2/03")));
  const ResidentTile* remembered = small.find("cube/2/03");
  ASSERT_TRUE(remembered);
  EXPECT_FALSE(remembered->drawable);
  EXPECT_EQ(remembered->subtreeHeights.minMeters, 1224);
  EXPECT_EQ(remembered->subtreeHeights.maxMeters, 1244);
  ASSERT_TRUE(remembered->ownHeights);
  EXPECT_EQ(remembered->ownHeights->minMeters, 1233);
  EXPECT_EQ(remembered->ownHeights->maxMeters, 1235);
}

TEST(TileResidency, WhatIsOnlyRememberedIsNotResident) {
  SmallResidency small;
  small.add("cube/2");
  EXPECT_TRUE(small.residency.groundBelow({0, 1, 0}, kMoonRadius, Scheme::Cube));
  small.evictAll();
  EXPECT_EQ(small.residency.size(), 0u);
  EXPECT_EQ(small.residency.bytes(), 0u);
  EXPECT_EQ(small.residency.rememberedSize(), 1u);
  EXPECT_EQ(small.residency.touch(path("cube/2"), {}), nullptr);
  EXPECT_EQ(small.residency.mesh(path("cube/2")), nullptr);
  EXPECT_FALSE(small.residency.groundBelow({0, 1, 0}, kMoonRadius, Scheme::Cube));
  EXPECT_THAT(small.evictAll(), IsEmpty());
}

TEST(TileResidency, NothingIsKnownOfATileThatNeverCame) {
  SmallResidency small;
  small.add("cube/2/0");
  small.evictAll();
  EXPECT_FALSE(small.find("cube/2"));
  EXPECT_FALSE(small.find("cube/2/1"));
}

TEST(TileResidency, ATileThatComesAgainIsDrawableWithItsNewHeights) {
  SmallResidency small;
  small.add("cube/2/03", 1234);
  small.evictAll();
  small.add("cube/2/03", -4321);
  ASSERT_TRUE(small.find("cube/2/03"));
  EXPECT_TRUE(small.find("cube/2/03")->drawable);
  EXPECT_EQ(small.find("cube/2/03")->ownHeights->maxMeters, -4320);
  EXPECT_EQ(small.residency.rememberedSize(), 0u);
  small.evictAll();
  EXPECT_FALSE(small.find("cube/2/03")->drawable);
  EXPECT_EQ(small.find("cube/2/03")->ownHeights->maxMeters, -4320);
}

TEST(TileResidency, RemembersNoMoreThanItsBoundAndForgetsTheOldestFirst) {
  SmallResidency small(3);
  for (const char* tile : {"cube/0", "cube/1", "cube/2", "cube/3", "cube/4"}) {
    small.add(tile);
    small.evictAll();
  }
  EXPECT_EQ(small.residency.rememberedSize(), 3u);
  for (const char* tile : {"cube/0", "cube/1"}) EXPECT_FALSE(small.find(tile)) << tile;
  for (const char* tile : {"cube/2", "cube/3", "cube/4"}) EXPECT_TRUE(small.find(tile)) << tile;
}

TEST(TileResidency, ATileEvictedAgainIsAmongTheNewest) {
  SmallResidency small(2);
  for (const char* tile : {"cube/0", "cube/1", "cube/0", "cube/2"}) {
    small.add(tile);
    small.evictAll();
  }
  EXPECT_TRUE(small.find("cube/0"));
  EXPECT_FALSE(small.find("cube/1"));
  EXPECT_TRUE(small.find("cube/2"));
}

TEST(TileResidency, OneTileThatComesAndGoesForEverTakesTheRoomOfOne) {
  SmallResidency small(4);
  small.add("cube/5");
  for (int round = 0; round < 100; ++round) {
    small.evictAll();
    EXPECT_EQ(small.residency.rememberedSize(), 1u);
    small.add("cube/5");
  }
  EXPECT_TRUE(small.find("cube/5")->drawable);
}

TEST(TileResidency, ANewRevisionForgetsWhatWasEvictedButKeepsWhatIsDrawn) {
  SmallResidency small;
  small.add("cube/0");
  small.evictAll();
  small.add("cube/1");
  small.residency.setRevision(kRevision);
  EXPECT_TRUE(small.find("cube/0")) << "the same revision changes nothing";
  small.residency.setRevision(kNextRevision);
  EXPECT_FALSE(small.find("cube/0"));
  ASSERT_TRUE(small.find("cube/1"));
  EXPECT_TRUE(small.find("cube/1")->drawable);
}

TEST(TileResidency, RemembersNothingOfATileOfAnotherRevision) {
  SmallResidency small;
  small.add("cube/0", 0, kRevision);
  small.residency.setRevision(kNextRevision);
  small.add("cube/1", 0, kNextRevision);
  EXPECT_EQ(small.evictAll().size(), 2u);
  EXPECT_FALSE(small.find("cube/0"));
  EXPECT_TRUE(small.find("cube/1"));
}

TEST(TileResidency, TheDrawnHeightIsThatOfTheDrawnTileAsItIsDrawnWhateverFinerIsThere) {
  SmallResidency small;
  small.add("cube/2/0000000000", 100);
  small.add("cube/2/00000000003", 160);
  small.add("cube/2/000000000033", 500);
  const double tiles = 1024;
  const glm::dvec3 below = cubeDirection(2, 2 * 0.9 / tiles - 1, 2 * 0.9 / tiles - 1);
  const auto drawn = [&](std::string_view tile, float morph) {
    TileMorph all{.own = morph};
    all.sides.fill(morph);
    const auto height =
        small.residency.drawnHeightBelow(3.0 * below, kMoonRadius, {{path("cube/3"), {}}, {path(tile), all}});
    return height.value_or(-1e9);
  };
  EXPECT_NEAR(small.residency.groundBelow(below, kMoonRadius, Scheme::Cube)->heightMeters, 500, 1)
      << "the finest ground";
  EXPECT_NEAR(drawn("cube/2/0000000000", 0), 100, 1);
  EXPECT_NEAR(drawn("cube/2/0000000000", 1), 100, 1) << "without a parent it is drawn as it is";
  EXPECT_NEAR(drawn("cube/2/00000000003", 0), 160, 1);
  EXPECT_NEAR(drawn("cube/2/00000000003", 0.5f), 130, 1);
  EXPECT_NEAR(drawn("cube/2/00000000003", 1), 100, 1);
  EXPECT_FALSE(small.residency.drawnHeightBelow(below, kMoonRadius, {}));
  EXPECT_FALSE(small.residency.drawnHeightBelow(glm::dvec3(0), kMoonRadius, {{path("cube/2/0000000000"), {}}}));
}

// A camera just over fine ground that looks ahead, where only coarse tiles have come, must not stand in their hills.
TEST(TileResidency, WhereNothingIsDrawnBelowTheGroundGoesOnAsItIsDrawnBeside) {
  SmallResidency small;
  small.add("cube/2/00000000", 50);
  small.add("cube/2/0000000000", 100);
  small.add("cube/2/00000000003", 160);
  small.add("cube/2/000000000033", 500);
  const double tiles = 1024;
  const glm::dvec3 below = cubeDirection(2, 2 * 0.9 / tiles - 1, 2 * 0.9 / tiles - 1);
  const auto drawn = [&](std::vector<DrawnTile> drawnTiles) {
    return small.residency.drawnHeightBelow(below, kMoonRadius, drawnTiles).value_or(-1e9);
  };
  TileMorph half{.own = 0.5f};
  EXPECT_NEAR(drawn({{path("cube/2/0000000001"), {}}}), 100, 1) << "as fine as beside";
  EXPECT_NEAR(drawn({{path("cube/2/00000000012"), {}}}), 160, 1);
  EXPECT_NEAR(drawn({{path("cube/2/00000000012"), half}}), 130, 1) << "and as far on its way";
  EXPECT_NEAR(drawn({{path("cube/2/00000000002"), {}}}), 160, 1) << "of the same parent";
  EXPECT_NEAR(drawn({{path("cube/2/00000000002"), {}}, {path("cube/2/0000000001"), {}}}), 160, 1) << "the nearer";
  EXPECT_NEAR(drawn({{path("cube/2/000000001"), {}}}), 50, 1) << "none as coarse is there: the next one above";
  EXPECT_EQ(drawn({{path("cube/3"), {}}}), -1e9) << "nothing as coarse as what is drawn";
}

TEST(TileResidency, ClearingForgetsEverything) {
  SmallResidency small;
  small.add("cube/0");
  small.evictAll();
  small.add("cube/1");
  small.residency.clear();
  EXPECT_FALSE(small.find("cube/0"));
  EXPECT_FALSE(small.find("cube/1"));
  EXPECT_EQ(small.residency.rememberedSize(), 0u);
}

}  // namespace
}  // namespace terrane

// What a viewer does when the scene changes under it: another revision, another list of bodies, or an old scene from
// somewhere on the way.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "client/tiles/tile_stream.h"
#include "tests/unit/client/small_world.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace terrane::testing;
using ::testing::IsEmpty;

TEST(TileStreamScene, AGoneRevisionMovesOverWithoutAHole) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  const auto before = together({chain(path("cube/0/01")), chain(path("cube/0/02"))});
  ASSERT_TRUE(viewer.settle(before));
  const SceneInfo* oldScene = viewer.stream().scene();
  world.setRevision(kNextRevision);
  viewer.frame(before);
  EXPECT_EQ(viewer.stream().status().requests, before.size() + 1)
      << "what is there is not asked for again without a reason";

  const auto after = together({before, chain(path("cube/0/03"))});
  ASSERT_TRUE(viewer.stepUntil(after, [&] {
    for (const WantedTile& tile : before)
      EXPECT_TRUE(viewer.stream().resident(tile.path)) << "a hole at " << tile.path.text();
    return viewer.stream().scene()->bodies[0].revision == kNextRevision && viewer.stream().idle();
  }));
  EXPECT_NE(viewer.stream().scene(), oldScene);
  EXPECT_EQ(oldScene->bodies[0].revision, kRevision) << "the old scene can still be read";
  EXPECT_EQ(world.asked("scene.json"), 2);
  EXPECT_EQ(world.asked(target(path("cube/0/03"))), 1) << "one tile told that the revision is gone";
  for (const WantedTile& tile : after) EXPECT_EQ(world.asked(target(tile.path, kNextRevision)), 1) << tile.path.text();
  EXPECT_EQ(viewer.stream().status().resident, after.size());
  EXPECT_EQ(viewer.uploads, static_cast<int>(before.size() + after.size()));
  EXPECT_THAT(viewer.stream().status().message, IsEmpty());
}

TEST(TileStreamScene, ANewSceneIsFoundWhenTheServerKnowsNothingOfTheOldOne) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/01"))));
  world.setRevision(kNextRevision);
  world.setRule([](const std::string&, const FakeReply& usual) {
    return usual.status == 410 ? FakeReply{.status = 404} : usual;
  });
  const auto after = together({chain(path("cube/0/01")), chain(path("cube/0/03"))});
  ASSERT_TRUE(viewer.settle(after));
  EXPECT_EQ(viewer.stream().body()->revision, kNextRevision);
  EXPECT_EQ(viewer.stream().status().failed, 0u);
  EXPECT_TRUE(viewer.stream().resident(path("cube/0/03")));
  EXPECT_EQ(world.asked("scene.json"), 2);
  EXPECT_THAT(viewer.stream().status().message, IsEmpty());
}

TEST(TileStreamScene, ANewSceneIsFoundThoughTheServerFirstHoldsTheOldOne) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/01"))));
  world.setRevision(kNextRevision);
  const auto oldScene = wrongAtFirst("scene.json", 3, FakeReply{.body = writeSceneJson(smallScene(kRevision))});
  world.setRule([oldScene](const std::string& target, const FakeReply& usual) {
    return usual.status == 410 ? FakeReply{.status = 404} : oldScene(target, usual);
  });
  const auto after = chain(path("cube/0/03"));
  ASSERT_TRUE(viewer.stepUntil(after, [&] { return viewer.stream().resident(path("cube/0/03")) != nullptr; }));
  EXPECT_EQ(viewer.stream().body()->revision, kNextRevision);
  EXPECT_EQ(viewer.stream().status().failed, 0u);
}

TEST(TileStreamScene, ABodyThatWasAwayComesBack) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/01"))));
  SceneInfo other = smallScene(kNextRevision);
  std::erase_if(other.bodies, [name = viewer.stream().body()->name](const BodyInfo& b) { return b.name == name; });
  ASSERT_FALSE(other.bodies.empty());
  world.setRule([text = writeSceneJson(other)](const std::string& target, const FakeReply&) {
    return target.ends_with("scene.json") ? FakeReply{.body = text} : FakeReply{.status = 404};
  });
  const auto wanted = chain(path("cube/0/03"));
  ASSERT_TRUE(viewer.stepUntil(
      wanted, [&] { return viewer.stream().status().message.find("no longer has the body") != std::string::npos; }));
  world.setRule({});
  ASSERT_TRUE(viewer.stepUntil(wanted, [&] { return viewer.stream().resident(path("cube/0/03")) != nullptr; }));
  EXPECT_EQ(viewer.stream().body()->revision, kRevision);
  EXPECT_EQ(viewer.stream().status().failed, 0u);
}

TEST(TileStreamScene, ManyTilesThatAreNotFoundAreNoStormOfScenes) {
  RunningWorld world([](const std::string& target, const FakeReply& usual) {
    return target.ends_with(".glb") ? FakeReply{.status = 404} : usual;
  });
  StreamOptions options = quickOptions(world.url());
  options.firstBackoff = options.longestBackoff = 1h;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0")))) << "the first is asked for at once";
  std::size_t failures = 1;
  for (const char* leaf : {"cube/1/01", "cube/2/02", "cube/3/03", "cube/4/012"}) {
    const auto wanted = chain(path(leaf));
    failures += wanted.size();
    ASSERT_TRUE(viewer.stepUntil(wanted, [&] { return viewer.stream().status().failed == failures; })) << leaf;
  }
  for (int i = 0; i < 100; ++i) viewer.frame(chain(path("cube/4/012")));
  EXPECT_EQ(world.asked("scene.json"), 2);
  EXPECT_EQ(world.tilesAsked(), static_cast<int>(failures)) << "nor is a tile asked for twice";
}

TEST(TileStreamScene, ABodyIsFollowedByNameWhereverANewSceneListsIt) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/01"))));
  const std::string name = viewer.stream().body()->name;
  SceneInfo next = smallScene(kNextRevision);
  ASSERT_GE(next.bodies.size(), 2u);
  std::reverse(next.bodies.begin(), next.bodies.end());
  world.setRule([text = writeSceneJson(next)](const std::string& target, const FakeReply& usual) {
    return target.ends_with("scene.json") ? FakeReply{.body = text} : usual;
  });
  world.setRevision(kNextRevision);
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/03"))));
  EXPECT_EQ(viewer.stream().body()->name, name);
  EXPECT_EQ(viewer.stream().body()->revision, kNextRevision);
  EXPECT_NE(viewer.stream().scene()->bodies[0].name, name);
}

TEST(TileStreamScene, AnOldSceneFromACacheOnTheWayIsAskedForAgainAndAgain) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  world.setRevision(kNextRevision);
  world.setRule(wrongAtFirst("scene.json", 3, FakeReply{.body = writeSceneJson(smallScene(kRevision))}));
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/03"))));
  EXPECT_EQ(world.asked("scene.json"), 5);
  EXPECT_TRUE(viewer.stream().resident(path("cube/0/03")));
  EXPECT_LE(world.tilesAsked(), 6) << "no tile is asked for while the revision is known to be gone";
}

}  // namespace
}  // namespace terrane

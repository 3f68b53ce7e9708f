// What a viewer does when the server is dead, slow, busy, restarted, renewed or wrong, and what its disk cache is good
// for then.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "client/tiles/disk_cache.h"
#include "client/tiles/tile_stream.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/client/small_world.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace terrane::testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_support::TemporaryFolder;

/// A viewer that came before and left its disk cache filled.
bool fillCache(const StreamOptions& options, const std::vector<WantedTile>& wanted) {
  SmallViewer viewer(options);
  return viewer.waitForScene() && viewer.settle(wanted);
}

TEST(TileStreamTrouble, ADeadServerIsNamedAndTriedAgainUntilItIsThere) {
  SmallWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.stepUntil({}, [&] { return viewer.stream().status().link == LinkState::Offline; }));
  EXPECT_THAT(viewer.stream().status().message, HasSubstr(world.url() + " does not answer: "));
  EXPECT_FALSE(viewer.stream().idle());
  world.start();
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/1"))));
  EXPECT_EQ(viewer.stream().status().link, LinkState::Online);
  EXPECT_THAT(viewer.stream().status().message, IsEmpty());
}

TEST(TileStreamTrouble, SaysInHowManySecondsItTriesAgain) {
  SmallWorld world;
  StreamOptions options = quickOptions(world.url());
  options.firstBackoff = options.longestBackoff = 1h;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.stepUntil({}, [&] { return viewer.stream().status().link == LinkState::Offline; }));
  EXPECT_THAT(viewer.stream().status().message,
              ::testing::MatchesRegex(".* does not answer: retry in 3[56][0-9][0-9] s"));
  EXPECT_EQ(viewer.stream().status().requests, 1u) << "no flood";
}

TEST(TileStreamTrouble, ASilentServerIsSlowThenOffline) {
  RunningWorld world(holding(""));
  StreamOptions options = quickOptions(world.url());
  options.slowAfter = 20ms;
  options.requestTimeout = 2s;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.stepUntil({}, [&] { return viewer.stream().status().link == LinkState::Slow; }));
  EXPECT_THAT(viewer.stream().status().message, HasSubstr("is slow"));
  ASSERT_TRUE(viewer.stepUntil({}, [&] { return viewer.stream().status().link == LinkState::Offline; }));
  world.server().releaseAll();
  ASSERT_TRUE(viewer.waitForScene());
  EXPECT_EQ(viewer.stream().status().link, LinkState::Online);
}

TEST(TileStreamTrouble, ARestartInTheMiddleOfLoadingIsOvercome) {
  RunningWorld world(holding("3.glb"));
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  const auto wanted = together({chain(path("cube/0/3333")), chain(path("cube/1/0123"))});
  viewer.frame(wanted);
  ASSERT_TRUE(world.server().waitForHolding(2));
  world.stop();
  ASSERT_TRUE(viewer.stepUntil(wanted, [&] { return viewer.stream().status().link == LinkState::Offline; }));
  const std::size_t resident = viewer.stream().status().resident;
  world.setRule(nullptr);
  world.start();
  ASSERT_TRUE(viewer.settle(wanted));
  EXPECT_GE(viewer.stream().status().resident, resident) << "nothing that was there went away";
  EXPECT_EQ(viewer.stream().status().resident, wanted.size());
  EXPECT_EQ(viewer.stream().status().failed, 0u);
}

TEST(TileStreamTrouble, ABusyServerIsAskedAgainWhenItSaid) {
  RunningWorld world(wrongAtFirst("/cube/0/1.glb", 1, FakeReply{.status = 503, .headers = "Retry-After: 1\r\n"}));
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  const auto begun = std::chrono::steady_clock::now();
  bool said = false;
  ASSERT_TRUE(viewer.stepUntil(chain(path("cube/0/1")), [&] {
    said = said || viewer.stream().status().message.find("is busy: retry in") != std::string::npos;
    return viewer.stream().idle();
  }));
  EXPECT_TRUE(said);
  EXPECT_GE(std::chrono::steady_clock::now() - begun, 1s);
  EXPECT_EQ(world.asked("/cube/0/1.glb"), 2);
  EXPECT_TRUE(viewer.stream().resident(path("cube/0/1")));
}

TEST(TileStreamTrouble, PassingErrorsAreTriedAgain) {
  for (const FakeReply& wrong :
       {FakeReply{.status = 500}, FakeReply{.status = 503}, FakeReply{.status = 429}, FakeReply{.body = "no tile"},
        FakeReply{.body = ""}, FakeReply{.raw = "nonsense\r\n\r\n"},
        FakeReply{.body = smallTileBytes(path("cube/5"))}}) {
    RunningWorld world(wrongAtFirst("/cube/0/1.glb", 2, wrong));
    SmallViewer viewer(quickOptions(world.url()));
    ASSERT_TRUE(viewer.waitForScene());
    ASSERT_TRUE(viewer.settle(chain(path("cube/0/1"))));
    EXPECT_TRUE(viewer.stream().resident(path("cube/0/1"))) << wrong.status << wrong.raw;
    EXPECT_EQ(world.asked("/cube/0/1.glb"), 3) << wrong.status << wrong.raw;
    EXPECT_THAT(viewer.stream().status().message, IsEmpty());
  }
}

TEST(TileStreamTrouble, WhatCannotBeHadIsAskedForOnceAndNamed) {
  for (const int status : {404, 400, 301}) {
    RunningWorld world(wrongAtFirst("/cube/0/1.glb", 1000, FakeReply{.status = status}));
    SmallViewer viewer(quickOptions(world.url()));
    ASSERT_TRUE(viewer.waitForScene());
    ASSERT_TRUE(viewer.settle(chain(path("cube/0/12"))));
    for (int i = 0; i < 100; ++i) viewer.frame(chain(path("cube/0/12")));
    EXPECT_EQ(world.asked("/cube/0/1.glb"), 1);
    if (status == 404)
      EXPECT_GE(world.asked("scene.json"), 2) << "another scene would explain it";
    else
      EXPECT_EQ(world.asked("scene.json"), 1);
    EXPECT_TRUE(viewer.stream().idle());
    const StreamStatus state = viewer.stream().status();
    EXPECT_EQ(state.failed, 1u);
    EXPECT_EQ(state.resident, 2u);
    EXPECT_THAT(state.message, AllOf(HasSubstr("cube/0/1"), HasSubstr(std::to_string(status))));
  }
}

TEST(TileStreamTrouble, ABrokenTileIsGivenUpAfterThreeTries) {
  for (const std::string& body : {std::string("glTF but not really"), smallTileBytes(path("cube/3/3"))}) {
    RunningWorld world(wrongAtFirst("/cube/0/1.glb", 1000, FakeReply{.body = body}));
    SmallViewer viewer(quickOptions(world.url()));
    ASSERT_TRUE(viewer.waitForScene());
    ASSERT_TRUE(viewer.settle(chain(path("cube/0/1"))));
    EXPECT_EQ(world.asked("/cube/0/1.glb"), 3);
    EXPECT_EQ(viewer.stream().status().failed, 1u);
    EXPECT_FALSE(viewer.stream().resident(path("cube/3/3"))) << "never under another name";
  }
}

TEST(TileStreamTrouble, AWrongSceneIsNamedAndTriedAgain) {
  RunningWorld world(wrongAtFirst("scene.json", 3, FakeReply{.body = "{\"bodies\": 7}"}));
  StreamOptions options = quickOptions(world.url());
  SmallViewer viewer(options);
  bool named = false;
  ASSERT_TRUE(viewer.stepUntil({}, [&] {
    named = named || viewer.stream().status().message.find("/v1/scene.json: ") != std::string::npos;
    return viewer.stream().scene() != nullptr;
  }));
  EXPECT_TRUE(named);
  EXPECT_EQ(world.asked("scene.json"), 4);
}

TEST(TileStreamTrouble, ASecondStartNeedsNoServer) {
  const TemporaryFolder folder;
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.cacheFile = folder / "cache.sqlite";
  const auto wanted = together({chain(path("cube/0/0123")), chain(path("cube/2/3"))});
  {
    SmallViewer viewer(options);
    ASSERT_TRUE(viewer.waitForScene());
    ASSERT_TRUE(viewer.settle(wanted));
    EXPECT_EQ(viewer.stream().status().cacheHits, 0u);
  }
  const int asked = world.tilesAsked();
  {
    SmallViewer viewer(options);
    ASSERT_TRUE(viewer.waitForScene());
    ASSERT_TRUE(viewer.settle(wanted));
    EXPECT_EQ(world.tilesAsked(), asked) << "with the server there, nothing is fetched twice either";
    EXPECT_EQ(viewer.stream().status().cacheHits, wanted.size());
  }
  world.stop();
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(wanted)) << "idle, so that a capture can end";
  EXPECT_EQ(viewer.stream().status().resident, wanted.size());
  EXPECT_EQ(viewer.stream().status().link, LinkState::Offline);
  EXPECT_THAT(viewer.stream().status().message, AllOf(HasSubstr("does not answer"), HasSubstr("disk cache")));
  // What the disk does not have comes when the server does.
  const auto more = together({wanted, chain(path("cube/4/0"))});
  viewer.frame(more);
  EXPECT_FALSE(viewer.stream().idle());
  world.start();
  ASSERT_TRUE(viewer.settle(more));
  ASSERT_TRUE(viewer.stepUntil(more, [&] { return viewer.stream().status().message.empty(); }));
  EXPECT_EQ(viewer.stream().status().link, LinkState::Online);
}

TEST(TileStreamTrouble, ASilentServerDoesNotKeepTheCacheFromBeingShown) {
  const TemporaryFolder folder;
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.cacheFile = folder / "cache.sqlite";
  const auto wanted = chain(path("cube/0/01"));
  ASSERT_TRUE(fillCache(options, wanted));
  world.setRule(holding(""));
  options.slowAfter = 10ms;  // the request itself may take half a minute
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(wanted));
  EXPECT_TRUE(viewer.stepUntil(wanted, [&] { return viewer.stream().status().link == LinkState::Slow; }));
}

TEST(TileStreamTrouble, AnOldRevisionOnDiskIsLeftBehindWhenTheServerIsBack) {
  const TemporaryFolder folder;
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.cacheFile = folder / "cache.sqlite";
  const auto wanted = chain(path("cube/0/01"));
  ASSERT_TRUE(fillCache(options, wanted));
  world.stop();
  world.setRevision(kNextRevision);
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(wanted));
  world.start();
  ASSERT_TRUE(viewer.stepUntil(wanted, [&] {
    EXPECT_TRUE(viewer.stream().resident(path("cube/0/01")));
    return viewer.stream().scene()->bodies[0].revision == kNextRevision && viewer.stream().idle();
  }));
  for (const WantedTile& tile : wanted) EXPECT_EQ(world.asked(target(tile.path, kNextRevision)), 1);
}

TEST(TileStreamTrouble, ACachedTileThatDoesNotDecodeIsDeletedAndFetched) {
  const TemporaryFolder folder;
  const std::string file = folder / "cache.sqlite";
  const FacePath tile = path("cube/0/1");
  const std::string rubbish = "not a tile";
  {
    auto cache = DiskCache::open(file, 1 << 20);
    ASSERT_TRUE(cache);
    (*cache)->put(target(tile), {reinterpret_cast<const std::uint8_t*>(rubbish.data()), rubbish.size()});
  }
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.cacheFile = file;
  {
    SmallViewer viewer(options);
    ASSERT_TRUE(viewer.waitForScene());
    ASSERT_TRUE(viewer.settle(chain(tile)));
    EXPECT_TRUE(viewer.stream().resident(tile));
    EXPECT_EQ(world.asked(target(tile)), 1);
    EXPECT_EQ(viewer.stream().status().failed, 0u);
  }
  auto cache = DiskCache::open(file, 1 << 20);
  const auto content = (*cache)->get(target(tile));
  ASSERT_TRUE(content);
  EXPECT_EQ(std::string(content->begin(), content->end()), smallTileBytes(tile));
}

TEST(TileStreamTrouble, ADamagedCacheFileStopsNothingAndIsNamed) {
  const TemporaryFolder folder;
  const std::string file = folder / "cache.sqlite";
  FILE* stream = std::fopen(file.c_str(), "w");
  ASSERT_TRUE(stream);
  std::fputs("this is not a database", stream);
  std::fclose(stream);
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.cacheFile = file;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/1"))));
  EXPECT_THAT(viewer.stream().status().message, HasSubstr(file + ".corrupt"));
  EXPECT_TRUE(std::filesystem::exists(file + ".corrupt"));
}

TEST(TileStreamTrouble, ACacheFileThatCannotBeIsAnErrorThatNamesIt) {
  const TemporaryFolder folder;
  SmallWorld world;
  StreamOptions options = quickOptions(world.url());
  options.cacheFile = folder.path();
  const auto stream = TileStream::open(options, nullptr);
  ASSERT_FALSE(stream);
  EXPECT_EQ(stream.error().kind, ErrorKind::Io);
  EXPECT_EQ(stream.error().field, folder.path());
}

}  // namespace
}  // namespace terrane

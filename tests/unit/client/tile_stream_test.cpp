#include "client/tiles/tile_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "client/tiles/tile_pipeline.h"
#include "common/tiling/cube_sphere.h"
#include "proto/tile_url.h"
#include "tests/unit/client/small_world.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace terrane::testing;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// So that the order of requests is that of the queue.
StreamOptions oneConnection(const std::string& url) {
  StreamOptions options = quickOptions(url);
  options.connections = 1;
  return options;
}

TEST(TileStream, WrongServerNamesTheFlag) {
  const auto stream = TileStream::open(quickOptions("moon.example"), nullptr);
  ASSERT_FALSE(stream);
  EXPECT_EQ(stream.error().field, "--server");
}

TEST(TileStream, BringsTheWholeChainWithOneRequestATile) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  EXPECT_FALSE(viewer.stream().idle()) << "there is no scene yet";
  ASSERT_TRUE(viewer.waitForScene());
  EXPECT_EQ(viewer.stream().scene()->bodies[0].revision, kRevision);
  const auto wanted = together({chain(path("cube/0/0123")), chain(path("cube/0/0122")), chain(path("cube/3/1"))});
  ASSERT_TRUE(viewer.settle(wanted));
  for (const WantedTile& tile : wanted) {
    ASSERT_TRUE(viewer.stream().resident(tile.path)) << tile.path.text();
    EXPECT_EQ(viewer.stream().resident(tile.path)->subtreeHeights.maxMeters, 100);
    EXPECT_EQ(world.asked(target(tile.path)), 1);
  }
  const StreamStatus status = viewer.stream().status();
  EXPECT_EQ(status.link, LinkState::Online);
  EXPECT_THAT(status.message, IsEmpty());
  EXPECT_EQ(status.resident, wanted.size());
  EXPECT_EQ(status.requests, wanted.size() + 1);
  EXPECT_EQ(status.queued + status.fetching + status.decoding + status.ready + status.failed, 0u);
  EXPECT_GT(status.decodeMs, 0);
  EXPECT_EQ(status.quickDecodes, wanted.size() - 1) << "the first tile teaches the kind";
  EXPECT_GE(status.residentBytes, wanted.size() * SmallViewer::kGpuBytes);
}

TEST(TileStream, AncestorsAndLeavesAreAskedForAtOnceCoarsestFirstThenLargestError) {
  RunningWorld world(holding("/cube/0.glb"));
  SmallViewer viewer(oneConnection(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  viewer.frame({{path("cube/0"), 100, false},
                {path("cube/0/12"), 50, true},
                {path("cube/0/13"), 60, true},
                {path("cube/0/1"), 10, false},
                {path("cube/0/2"), 20, true},
                {path("cube/1"), 1, true}});
  ASSERT_TRUE(world.server().waitForHolding(1));
  EXPECT_EQ(viewer.stream().status().queued, 5u) << "no round trip between a tile and its parent";
  world.server().releaseAll();
  ASSERT_TRUE(world.server().waitForRequests(7));
  EXPECT_THAT(world.server().targets(),
              ElementsAre("/v1/scene.json", target(path("cube/0")), target(path("cube/1")), target(path("cube/0/2")),
                          target(path("cube/0/1")), target(path("cube/0/13")), target(path("cube/0/12"))));
}

TEST(TileStream, WhatLiesBesideThePictureIsAskedForAfterAllThatIsInIt) {
  RunningWorld world(holding("/cube/0.glb"));
  SmallViewer viewer(oneConnection(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  viewer.frame({{path("cube/0"), 100, false},
                {path("cube/1"), 100, true, true},
                {path("cube/0/1"), 10, false},
                {path("cube/0/12"), 1, true}});
  ASSERT_TRUE(world.server().waitForHolding(1));
  world.server().releaseAll();
  ASSERT_TRUE(world.server().waitForRequests(5));
  EXPECT_THAT(world.server().targets(), ElementsAre("/v1/scene.json", target(path("cube/0")), target(path("cube/0/1")),
                                                    target(path("cube/0/12")), target(path("cube/1"))));
}

TEST(TileStream, HandsOverWithinTheBudgetCoarsestFirst) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  const auto wanted = chain(path("cube/5/3210"));
  viewer.stream().want(wanted);
  while (viewer.stream().status().ready < wanted.size()) ASSERT_TRUE(viewer.waitForWake());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto tiles = viewer.stream().takeDecoded(1);
    ASSERT_EQ(tiles.size(), 1u) << "one, even if it is over the budget";
    EXPECT_EQ(tiles[0].tile->metadata.path, wanted[i].path);
    EXPECT_FALSE(viewer.stream().idle()) << "a tile that was taken is not drawn yet";
    viewer.stream().markResident(tiles[0], 1);
  }
  EXPECT_THAT(viewer.stream().takeDecoded(1), IsEmpty());
  EXPECT_TRUE(viewer.stream().idle());
}

TEST(TileStream, AViewerThatOnlyStepsWhenWokenSeesEverything) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  while (!viewer.stream().scene()) ASSERT_TRUE(viewer.waitForWake());
  viewer.stream().selectBody(0);
  const auto wanted = together({chain(path("cube/0/000111222")), chain(path("cube/1/333"))});
  viewer.frame(wanted);
  while (!viewer.stream().idle()) {
    ASSERT_TRUE(viewer.waitForWake());
    viewer.frame(wanted);
  }
  EXPECT_EQ(viewer.uploads, static_cast<int>(wanted.size()));
}

TEST(TileStream, CancelsWhatIsNoLongerWantedAfterTheGrace) {
  RunningWorld world(holding(".glb"));
  StreamOptions options = quickOptions(world.url());
  options.connections = 1;
  options.graceTime = 1h;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  viewer.frame(chain(path("cube/0/0123")));
  ASSERT_TRUE(world.server().waitForHolding(1));
  for (std::uint64_t call = 1; call < kGraceCalls; ++call) viewer.frame({});
  EXPECT_EQ(viewer.stream().status().cancelled, 0u);
  viewer.frame({});
  EXPECT_EQ(viewer.stream().status().cancelled, 5u);
  ASSERT_TRUE(world.server().waitForAbandoned(1)) << "the server may drop the work";
  ASSERT_TRUE(viewer.settle({}));
  EXPECT_EQ(world.tilesAsked(), 1) << "what was queued was never sent";
}

TEST(TileStream, WantedAgainWithinTheGraceIsNotAskedForTwice) {
  RunningWorld world(holding(".glb"));
  StreamOptions options = quickOptions(world.url());
  options.graceTime = 1h;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  const auto wanted = chain(path("cube/0/0123"));
  for (int round = 0; round < 20; ++round) {
    viewer.frame(wanted);
    for (std::uint64_t call = 1; call < kGraceCalls; ++call) viewer.frame({});
  }
  viewer.frame(wanted);
  world.server().releaseAll();
  ASSERT_TRUE(viewer.settle(wanted));
  EXPECT_EQ(world.tilesAsked(), static_cast<int>(wanted.size()));
  EXPECT_EQ(viewer.stream().status().cancelled, 0u);
}

TEST(TileStream, WantedTilesOvertakeThoseInTheirGrace) {
  RunningWorld world(holding("/cube/0.glb"));
  StreamOptions options = quickOptions(world.url());
  options.connections = 1;
  options.graceTime = 1h;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  viewer.frame(chain(path("cube/0/12")));
  ASSERT_TRUE(world.server().waitForHolding(1));
  viewer.frame(chain(path("cube/4/301")));
  world.server().releaseAll();
  ASSERT_TRUE(world.server().waitForRequests(8));
  EXPECT_THAT(world.server().targets(),
              ElementsAre("/v1/scene.json", target(path("cube/0")), target(path("cube/4")), target(path("cube/4/3")),
                          target(path("cube/4/30")), target(path("cube/4/301")), target(path("cube/0/1")),
                          target(path("cube/0/12"))));
}

TEST(TileStream, SteppingBackAndForthOverAThresholdFetchesAndEvictsNothingTwice) {
  RunningWorld world;
  const auto coarse = chain(path("cube/0/01"));
  const auto fine = together(
      {chain(path("cube/0/010")), chain(path("cube/0/011")), chain(path("cube/0/012")), chain(path("cube/0/013"))});
  StreamOptions options = quickOptions(world.url());
  options.residentBudgetBytes = fine.size() * (SmallViewer::kGpuBytes + 1000);
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(fine));
  const std::uint64_t requests = viewer.stream().status().requests;
  for (int step = 0; step < 1000; ++step) viewer.frame(step % 2 ? fine : coarse);
  ASSERT_TRUE(viewer.settle(fine));
  EXPECT_EQ(viewer.stream().status().requests, requests);
  EXPECT_EQ(viewer.stream().status().evicted, 0u);
  EXPECT_EQ(viewer.uploads, static_cast<int>(fine.size()));
}

TEST(TileStream, SteppingWhileLoadingAndOverBudgetFetchesNothingTwiceWithinTheGrace) {
  RunningWorld world;
  const auto a = together({chain(path("cube/0/0100")), chain(path("cube/0/0113"))});
  const auto b = together({chain(path("cube/0/3100")), chain(path("cube/0/3113"))});
  const auto both = together({a, b});
  StreamOptions options = quickOptions(world.url());
  options.graceTime = 1h;
  options.residentBudgetBytes = a.size() * SmallViewer::kGpuBytes;  // too small for both
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  for (int step = 0; step < 1000; ++step) viewer.frame(step % 2 ? a : b);
  ASSERT_TRUE(viewer.settle(both));
  EXPECT_EQ(world.tilesAsked(), static_cast<int>(both.size()));
  EXPECT_EQ(viewer.stream().status().evicted, 0u);
}

TEST(TileStream, TheBudgetHoldsAndTheLeastRecentlyWantedGoesFirst) {
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  constexpr std::size_t kTiles = 12;
  options.residentBudgetBytes = kTiles * (SmallViewer::kGpuBytes + 500);
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  std::size_t most = 0;
  for (int face = 0; face < 6; ++face) {
    for (const char* digits : {"/0123", "/3210", "/1111"}) {
      const auto wanted = chain(path("cube/" + std::to_string(face) + digits));
      ASSERT_TRUE(viewer.settle(wanted));
      viewer.frame(wanted);
      most = std::max(most, viewer.stream().status().residentBytes);
      EXPECT_LE(viewer.stream().status().residentBytes, options.residentBudgetBytes);
      for (const WantedTile& tile : wanted) EXPECT_TRUE(viewer.stream().resident(tile.path)) << "never what is wanted";
      for (const FacePath& tile : viewer.uploaded) {
        EXPECT_TRUE(tile.level() == 0 || viewer.uploaded.contains(tile.parent()))
            << "never a parent of what stays: " << tile.text();
      }
    }
  }
  EXPECT_GT(most, options.residentBudgetBytes * 3 / 4) << "the budget is used";
  EXPECT_EQ(viewer.stream().status().resident, viewer.uploaded.size());
  EXPECT_EQ(viewer.stream().status().evicted, viewer.evicted.size());
  EXPECT_TRUE(viewer.uploaded.contains(path("cube/5/3210"))) << "wanted just before the last";
  EXPECT_FALSE(viewer.uploaded.contains(path("cube/0/0123"))) << "wanted first";
}

TEST(TileStream, NeverEvictsWhatIsDrawnHoweverSmallTheBudget) {
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.residentBudgetBytes = 1;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  const auto wanted = together({chain(path("cube/2/01")), chain(path("cube/2/31"))});
  ASSERT_TRUE(viewer.settle(wanted));
  EXPECT_EQ(viewer.stream().status().resident, wanted.size());
  // Drawn, though nobody wants it any more: it stays, and so does all above it.
  viewer.stream().want({});
  const auto gone = viewer.stream().evict({path("cube/2/31")});
  EXPECT_THAT(gone, ::testing::UnorderedElementsAre(path("cube/2/01"), path("cube/2/0")));
  EXPECT_TRUE(viewer.stream().resident(path("cube/2/31")));
  EXPECT_TRUE(viewer.stream().resident(path("cube/2/3")));
  EXPECT_TRUE(viewer.stream().resident(path("cube/2")));
  viewer.stream().want({});
  EXPECT_EQ(viewer.stream().evict({}).size(), 3u);
  EXPECT_EQ(viewer.stream().status().residentBytes, 0u);
}

TEST(TileStream, KeepsTheMeshOnlyAsLongAsSomebodyElseDoes) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  viewer.stream().want(chain(path("cube/0")));
  std::vector<ArrivedTile> tiles;
  while ((tiles = viewer.stream().takeDecoded(1)).empty()) ASSERT_TRUE(viewer.waitForWake());
  EXPECT_FALSE(viewer.stream().resident(path("cube/0")));
  EXPECT_FALSE(viewer.stream().tile(path("cube/0")));
  viewer.stream().markResident(tiles[0], 5000);
  EXPECT_EQ(viewer.stream().tile(path("cube/0")), tiles[0].tile);
  tiles.clear();
  EXPECT_FALSE(viewer.stream().tile(path("cube/0")));
  EXPECT_TRUE(viewer.stream().resident(path("cube/0")));
  EXPECT_LT(viewer.stream().status().residentBytes, 6000u);
}

TEST(TileStream, TheGroundIsThatOfTheFinestResidentTile) {
  RunningWorld world;
  StreamOptions options = quickOptions(world.url());
  options.residentBudgetBytes = 1;
  SmallViewer viewer(options);
  ASSERT_TRUE(viewer.waitForScene());
  const FacePath leaf = path("cube/2/031201");
  const double side = 64;
  const glm::dvec3 inside = cubeDirection(2, 2 * (leaf.column() + 0.3) / side - 1, 2 * (leaf.row() + 0.6) / side - 1);
  const glm::dvec3 elsewhere =
      cubeDirection(2, -2 * (leaf.column() + 0.3) / side + 1, 2 * (leaf.row() + 0.6) / side - 1);
  EXPECT_FALSE(viewer.stream().groundBelow(inside));
  ASSERT_TRUE(viewer.settle(chain(leaf)));
  const auto fine = viewer.stream().groundBelow(3.0 * inside);
  ASSERT_TRUE(fine) << "of any length";
  EXPECT_EQ(fine->level, 6);
  const double cell = nominalTileWidthMeters(kMoonRadius, 6) / kSmallCells;
  EXPECT_LE(fine->heightMeters, 1.0);
  EXPECT_GE(fine->heightMeters, -cell * cell / (4 * kMoonRadius) * 1.05 - 1.0);
  const auto coarse = viewer.stream().groundBelow(elsewhere);
  ASSERT_TRUE(coarse);
  EXPECT_EQ(coarse->level, 0);
  viewer.frame(chain(leaf.parent()));
  EXPECT_EQ(viewer.stream().groundBelow(inside)->level, 5) << "after the leaf was evicted";
  for (const glm::dvec3& nothing : {glm::dvec3(0), glm::dvec3(std::nan(""), 0, 1), -inside})
    EXPECT_FALSE(viewer.stream().groundBelow(nothing));
}

TEST(TileStream, AnotherBodyStartsEmpty) {
  RunningWorld world;
  SmallViewer viewer(quickOptions(world.url()));
  ASSERT_TRUE(viewer.waitForScene());
  ASSERT_TRUE(viewer.settle(chain(path("cube/0/1"))));
  viewer.stream().selectBody(1);
  EXPECT_FALSE(viewer.stream().resident(path("cube/0")));
  EXPECT_EQ(viewer.stream().status().residentBytes, 0u);
  ASSERT_TRUE(viewer.settle(chain(path("cube/0"))));
  EXPECT_EQ(world.asked(tileTarget({kRevision, "second", path("cube/0")})), 1);
}

TEST(TileStream, DestructionInTheMiddleOfEverythingIsQuiet) {
  SmallWorld world;
  int tile = 0;
  world.setRule([&tile](const std::string& asked, const FakeReply& usual) {
    FakeReply reply = usual;
    reply.hold = asked.ends_with(".glb") && tile++ % 3 == 0;
    return reply;
  });
  world.start();
  for (int round = 0; round < 10; ++round) {
    SmallViewer viewer(quickOptions(world.url()));
    ASSERT_TRUE(round == 0 || viewer.waitForScene());
    for (int i = 0; i < round; ++i) viewer.frame(together({chain(path("cube/1/0123")), chain(path("cube/4/3210"))}));
  }
}

TEST(TilePipeline, WhatIsReadyIsBoundedUntilItIsTaken) {
  RunningWorld world;
  FetchOptions network;
  network.serverUrl = world.url();
  auto fetch = FetchQueue::open(network);
  ASSERT_TRUE(fetch);
  const auto tiles = together({chain(path("cube/0/0123012301")), chain(path("cube/1/0123012301"))});
  const std::size_t one = meshBytes(smallTile(path("cube/0"), [](const glm::dvec3&) { return 0.0; }));
  PipelineOptions options;
  options.readyBudgetBytes = 2 * one;
  std::mutex mutex;
  std::condition_variable woken;
  TilePipeline pipeline(**fetch, nullptr, options, [&] {
    const std::lock_guard lock(mutex);
    woken.notify_all();
  });
  for (const WantedTile& tile : tiles) pipeline.order(tile.path, target(tile.path), tile.path.level());
  std::size_t taken = 0;
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (taken < tiles.size() && std::chrono::steady_clock::now() < deadline) {
    EXPECT_LE(pipeline.counts().ready, 3u);
    taken += pipeline.takeReady(one).size();
    std::unique_lock lock(mutex);
    woken.wait_for(lock, 1ms);
  }
  EXPECT_EQ(taken, tiles.size());
  pipeline.stop();
  fetch->reset();
}

}  // namespace
}  // namespace terrane

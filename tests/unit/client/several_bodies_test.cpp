// Tiles of several bodies through one stream: each body's tiles are its own, and what is shared (the order of requests,
// the budget) is shared.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <thread>

#include "client/tiles/tile_stream.h"
#include "tests/unit/client/small_world.h"

namespace terrane::testing {
namespace {

constexpr std::size_t kBodies = 2, kGpuBytes = 10'000;

class SeveralBodies : public ::testing::Test {
 protected:
  void open(StreamOptions options) {
    options.serverUrl = world_.url();
    stream_ = *TileStream::open(std::move(options), [] {});
    while (stream_->scene() == nullptr) std::this_thread::yield();
    stream_->selectBodies(std::array<std::size_t, kBodies>{0, 1});
  }
  /// One frame; what was uploaded, by body.
  void frame(const std::vector<WantedTile>& first, const std::vector<WantedTile>& second) {
    stream_->want(first, 0);
    stream_->want(second, 1);
    for (const ArrivedTile& arrived : stream_->takeDecoded(1 << 20)) {
      stream_->markResident(arrived, kGpuBytes);
      arrived_.push_back(arrived.tile->metadata.path);
    }
    const std::array<std::vector<FacePath>, kBodies> drawn{};
    gone_ = stream_->evictOfAll(drawn);
  }
  void settle(const std::vector<WantedTile>& first, const std::vector<WantedTile>& second) {
    do frame(first, second);
    while (!stream_->idle());
  }
  bool resident(std::string_view tile, std::size_t body) { return stream_->resident(path(tile), body) != nullptr; }

  RunningWorld world_;
  std::unique_ptr<TileStream> stream_;
  std::vector<FacePath> arrived_;
  std::vector<std::vector<FacePath>> gone_;
};

TEST_F(SeveralBodies, TilesOfOnePathAreOneOfEachBody) {
  open(quickOptions(world_.url()));
  ASSERT_NE(stream_->body(0)->name, stream_->body(1)->name);
  settle(chain(path("cube/3/1")), {});
  EXPECT_TRUE(resident("cube/3/1", 0));
  EXPECT_FALSE(resident("cube/3/1", 1));
  EXPECT_EQ(stream_->residentCount(0), 2u);
  EXPECT_EQ(stream_->residentCount(1), 0u);
  settle(chain(path("cube/3/1")), chain(path("cube/3/1")));
  EXPECT_TRUE(resident("cube/3/1", 1));
  EXPECT_EQ(world_.asked("/" + stream_->body(0)->name + "/cube/3/1.glb"), 1);
  EXPECT_EQ(world_.asked("/" + stream_->body(1)->name + "/cube/3/1.glb"), 1);
  EXPECT_EQ(stream_->status().resident, 4u);
}

TEST_F(SeveralBodies, CoarseTilesOfAllComeBeforeFineOnesOfAny) {
  StreamOptions options = quickOptions(world_.url());
  options.connections = options.decodeThreads = 1;
  open(options);
  const auto wanted = chain(path("cube/1/0123"));
  stream_->want(wanted, 0);
  stream_->want(wanted, 1);
  while (stream_->status().ready < 2 * wanted.size()) std::this_thread::yield();
  std::vector<int> levels;
  for (const ArrivedTile& arrived : stream_->takeDecoded(1 << 24))
    levels.push_back(arrived.tile->metadata.path.level());
  EXPECT_EQ(levels.size(), 2 * wanted.size());
  EXPECT_TRUE(std::ranges::is_sorted(levels));
}

TEST_F(SeveralBodies, OneBudgetHoldsForAllAndWhatIsWantedOfAnyStays) {
  StreamOptions options = quickOptions(world_.url());
  options.residentBudgetBytes = 8 * kGpuBytes;
  open(options);
  const auto left = chain(path("cube/0/00000")), right = chain(path("cube/1/11111"));
  settle(left, {});
  settle({}, left);
  EXPECT_LE(stream_->status().residentBytes, options.residentBudgetBytes) << "twelve were wanted, and no longer are";
  settle(right, right);
  for (const WantedTile& tile : right)
    for (std::size_t body = 0; body < kBodies; ++body)
      EXPECT_NE(stream_->resident(tile.path, body), nullptr) << tile.path.text() << " of body " << body;
  EXPECT_EQ(stream_->status().resident, 2 * right.size())
      << "a view that needs more than the budget has it, and no more";
  settle(right, {});
  EXPECT_LE(stream_->status().residentBytes, options.residentBudgetBytes);
  for (const WantedTile& tile : right) EXPECT_NE(stream_->resident(tile.path, 0), nullptr);
  EXPECT_GT(stream_->status().evicted, 0u);
}

TEST_F(SeveralBodies, WhatIsNoLongerWantedOfOneIsCancelledWithoutTheOther) {
  world_.setRule(holding("cube/4.glb"));
  open(quickOptions(world_.url()));
  frame(chain(path("cube/4")), chain(path("cube/4")));
  frame(chain(path("cube/4")), {});
  EXPECT_EQ(stream_->status().cancelled, 1u);
  world_.setRule(nullptr);
  world_.server().releaseAll();
  settle(chain(path("cube/4")), {});
  EXPECT_TRUE(resident("cube/4", 0));
  EXPECT_FALSE(resident("cube/4", 1));
}

}  // namespace
}  // namespace terrane::testing

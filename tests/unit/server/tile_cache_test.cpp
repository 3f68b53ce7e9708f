#include "server/store/tile_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <mutex>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/support/build_gate.h"

namespace terrane {
namespace {

TileKey keyAt(int level, std::uint32_t column = 0, std::uint32_t body = 0) {
  return {body, FacePath::cubeTile(0, level, column, 0)};
}

CachedTilePtr tileOfBytes(std::size_t bytes) {
  auto tile = std::make_shared<CachedTile>();
  tile->glb.resize(bytes);
  return tile;
}

/// Builds tiles of a given size, one worker, and can be held so that builds queue up behind it.
class CacheTest : public testing::Test {
 protected:
  void make(std::size_t maxBytes, std::size_t maxQueued = 100, int threads = 1) {
    pool.emplace(threads, maxQueued);
    cache.emplace(maxBytes, *pool, [this](const TileKey& key) { return build(key); });
  }

  Result<CachedTilePtr> build(const TileKey& key) {
    {
      const std::lock_guard lock(mutex);
      built.push_back(key);
    }
    gate.pass();
    if (onBuild) return onBuild(key);
    return tileOfBytes(tileBytes);
  }
  /// An answer to come, shared with the worker that gives it: it may still be at it when the answer has been read.
  using Answer = std::promise<Result<CachedTilePtr>>;
  std::unique_ptr<TileCache::Ticket> ask(const TileKey& key, const std::shared_ptr<Answer>& answer) {
    return cache->getOrBuild(key, [answer](Result<CachedTilePtr> tile) { answer->set_value(std::move(tile)); });
  }
  /// Asks and waits.
  Result<CachedTilePtr> get(const TileKey& key) {
    const auto answer = std::make_shared<Answer>();
    const auto ticket = ask(key, answer);
    return answer->get_future().get();
  }
  std::vector<TileKey> builtTiles() {
    const std::lock_guard lock(mutex);
    return built;
  }

  testing_support::BuildGate gate;
  std::mutex mutex;
  std::vector<TileKey> built;
  std::size_t tileBytes = 1000;
  std::function<Result<CachedTilePtr>(const TileKey&)> onBuild;
  std::optional<WorkerPool> pool;
  std::optional<TileCache> cache;
};

using TileCacheTest = CacheTest;

TEST_F(TileCacheTest, ConcurrentRequestsForOneTileBuildOnce) {
  make(1 << 20, 100, 2);
  gate.hold();
  constexpr int kWaiters = 32;
  std::atomic<int> answers{0};
  std::vector<std::unique_ptr<TileCache::Ticket>> tickets(kWaiters);
  std::vector<std::thread> threads;
  for (int i = 0; i < kWaiters; ++i)
    threads.emplace_back([&, i] {
      tickets[static_cast<std::size_t>(i)] = cache->getOrBuild(keyAt(3), [&](Result<CachedTilePtr> tile) {
        EXPECT_TRUE(tile);
        ++answers;
      });
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answers, 0);
  gate.release();
  while (answers < kWaiters) std::this_thread::yield();
  EXPECT_EQ(builtTiles().size(), 1u);
  EXPECT_EQ(cache->stats().builds, 1u);
  EXPECT_EQ(cache->stats().joined, static_cast<std::uint64_t>(kWaiters - 1));
  EXPECT_EQ(cache->stats().inFlight, 0u);
}

TEST_F(TileCacheTest, ASecondRequestIsAnsweredAtOnceFromMemory) {
  make(1 << 20);
  const Result<CachedTilePtr> first = get(keyAt(2));
  ASSERT_TRUE(first);
  bool called = false;
  const auto ticket = cache->getOrBuild(keyAt(2), [&](Result<CachedTilePtr> tile) {
    called = true;
    EXPECT_EQ(*tile, *first);
  });
  EXPECT_TRUE(called);
  EXPECT_EQ(ticket, nullptr);
  EXPECT_EQ(cache->find(keyAt(2)), *first);
  EXPECT_EQ(cache->find(keyAt(2, 0, 1)), nullptr) << "another body's tile of the same path";
  EXPECT_EQ(builtTiles().size(), 1u);
}

TEST_F(TileCacheTest, DroppedTicketCancelsQueuedBuild) {
  make(1 << 20);
  gate.hold();
  auto running = cache->getOrBuild(keyAt(1), [](const Result<CachedTilePtr>&) {});
  gate.waitForBuilds(1);
  bool called = false;
  auto dropped = cache->getOrBuild(keyAt(2), [&](const Result<CachedTilePtr>&) { called = true; });
  EXPECT_EQ(pool->queued(), 1u);
  dropped.reset();
  EXPECT_EQ(pool->queued(), 0u);
  EXPECT_EQ(cache->stats().dropped, 1u);
  EXPECT_EQ(cache->stats().inFlight, 1u);
  gate.release();
  EXPECT_TRUE(get(keyAt(3)));
  EXPECT_FALSE(called);
  EXPECT_THAT(builtTiles(), testing::ElementsAre(keyAt(1), keyAt(3)));
}

TEST_F(TileCacheTest, ABuildGoesOnWhileOneOfItsWaitersIsLeft) {
  make(1 << 20);
  gate.hold();
  auto running = cache->getOrBuild(keyAt(1), [](const Result<CachedTilePtr>&) {});
  gate.waitForBuilds(1);
  const auto served = std::make_shared<Answer>();
  bool droppedCalled = false;
  auto first = cache->getOrBuild(keyAt(2), [&](const Result<CachedTilePtr>&) { droppedCalled = true; });
  auto second = ask(keyAt(2), served);
  first.reset();
  gate.release();
  EXPECT_TRUE(served->get_future().get());
  EXPECT_FALSE(droppedCalled);
}

TEST_F(TileCacheTest, AfterADroppedBuildTheTileCanBeAskedForAgain) {
  make(1 << 20);
  gate.hold();
  auto running = cache->getOrBuild(keyAt(1), [](const Result<CachedTilePtr>&) {});
  gate.waitForBuilds(1);
  cache->getOrBuild(keyAt(2), [](const Result<CachedTilePtr>&) {}).reset();
  gate.release();
  EXPECT_TRUE(get(keyAt(2)));
}

TEST_F(TileCacheTest, ABuildThatRunsIsKeptEvenIfItsWaiterHasGone) {
  make(1 << 20);
  gate.hold();
  auto ticket = cache->getOrBuild(keyAt(1), [](const Result<CachedTilePtr>&) { FAIL() << "the ticket was dropped"; });
  gate.waitForBuilds(1);
  ticket.reset();
  gate.release();
  EXPECT_TRUE(get(keyAt(2)));  // one worker: the first build has ended
  EXPECT_NE(cache->find(keyAt(1)), nullptr);
}

TEST_F(TileCacheTest, CoarserTilesAreBuiltFirst) {
  make(1 << 20);
  gate.hold();
  std::vector<std::unique_ptr<TileCache::Ticket>> tickets;
  std::atomic<int> answers{0};
  const auto ask = [&](const TileKey& key) {
    tickets.push_back(cache->getOrBuild(key, [&](const Result<CachedTilePtr>&) { ++answers; }));
  };
  ask(keyAt(9));
  gate.waitForBuilds(1);
  for (const int level : {7, 2, 5, 0, 3}) ask(keyAt(level));
  gate.release();
  while (answers < 6) std::this_thread::yield();
  EXPECT_THAT(builtTiles(), testing::ElementsAre(keyAt(9), keyAt(0), keyAt(2), keyAt(3), keyAt(5), keyAt(7)));
}

TEST_F(TileCacheTest, ErrorsAreNotCachedAndReachEveryWaiter) {
  make(1 << 20);
  bool fail = true;
  onBuild = [&](const TileKey&) -> Result<CachedTilePtr> {
    if (fail) return makeError(ErrorKind::Internal, "", "no luck");
    return tileOfBytes(10);
  };
  gate.hold();
  const auto one = std::make_shared<Answer>(), two = std::make_shared<Answer>();
  auto first = ask(keyAt(1), one);
  auto second = ask(keyAt(1), two);
  gate.release();
  EXPECT_EQ(one->get_future().get().error().message, "no luck");
  EXPECT_EQ(two->get_future().get().error().message, "no luck");
  EXPECT_EQ(cache->stats().entries, 0u);
  fail = false;
  EXPECT_TRUE(get(keyAt(1)));
}

TEST_F(TileCacheTest, AnExceptionOfABuildIsAnInternalError) {
  make(1 << 20);
  onBuild = [](const TileKey&) -> Result<CachedTilePtr> { throw std::runtime_error("thrown by a test"); };
  const Result<CachedTilePtr> tile = get(keyAt(1));
  ASSERT_FALSE(tile);
  EXPECT_EQ(tile.error().kind, ErrorKind::Internal);
  EXPECT_THAT(tile.error().message, testing::HasSubstr("thrown by a test"));
}

TEST_F(TileCacheTest, AFullQueueIsOverloadedAtOnce) {
  make(1 << 20, 1);
  gate.hold();
  auto running = cache->getOrBuild(keyAt(1), [](const Result<CachedTilePtr>&) {});
  gate.waitForBuilds(1);
  auto queued = cache->getOrBuild(keyAt(2), [](const Result<CachedTilePtr>&) {});
  std::optional<ErrorKind> kind;
  const auto refused = cache->getOrBuild(keyAt(3), [&](Result<CachedTilePtr> tile) { kind = tile.error().kind; });
  EXPECT_EQ(kind, ErrorKind::Overloaded);
  EXPECT_EQ(refused, nullptr);
  EXPECT_EQ(cache->stats().refused, 1u);
  auto joined = cache->getOrBuild(keyAt(2), [](const Result<CachedTilePtr>&) {});
  EXPECT_NE(joined, nullptr) << "joining needs no place in the queue";
  gate.release();
  EXPECT_TRUE(get(keyAt(2)));
}

TEST_F(TileCacheTest, MemoryStaysWithinItsBoundAndTheLeastRecentlyUsedGoFirst) {
  tileBytes = 1000;
  const std::size_t each = tileBytes + TileCache::kEntryOverheadBytes + 2 * std::string().capacity();
  make(4 * each);
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_TRUE(get(keyAt(5, i)));
  EXPECT_EQ(cache->stats().entries, 4u);
  EXPECT_EQ(cache->stats().bytes, 4 * each);
  EXPECT_NE(cache->find(keyAt(5, 0)), nullptr);  // now the most recently used
  EXPECT_TRUE(get(keyAt(5, 4)));
  EXPECT_EQ(cache->stats().evicted, 1u);
  EXPECT_EQ(cache->find(keyAt(5, 1)), nullptr);
  EXPECT_NE(cache->find(keyAt(5, 0)), nullptr);
  for (std::uint32_t i = 10; i < 300; ++i) {
    tileBytes = 200 + 37 * (i % 50);
    EXPECT_TRUE(get(keyAt(9, i)));
    ASSERT_LE(cache->stats().bytes, 4 * each);
  }
}

TEST_F(TileCacheTest, ATileLargerThanTheCacheIsServedButNotKept) {
  make(5000);
  EXPECT_TRUE(get(keyAt(1)));
  tileBytes = 6000;
  const Result<CachedTilePtr> large = get(keyAt(2));
  ASSERT_TRUE(large);
  EXPECT_EQ((*large)->glb.size(), 6000u);
  EXPECT_EQ(cache->find(keyAt(2)), nullptr);
  EXPECT_NE(cache->find(keyAt(1)), nullptr) << "nothing is evicted in vain";
}

TEST_F(TileCacheTest, ACacheOfNoBytesStillServes) {
  make(0);
  EXPECT_TRUE(get(keyAt(1)));
  EXPECT_TRUE(get(keyAt(1)));
  EXPECT_EQ(cache->stats().entries, 0u);
  EXPECT_EQ(builtTiles().size(), 2u);
}

TEST_F(TileCacheTest, DestroyingTheCacheCancelsQueuedAndRunningWaiters) {
  make(1 << 20);
  gate.hold();
  const auto running = std::make_shared<Answer>(), queued = std::make_shared<Answer>();
  auto first = ask(keyAt(1), running);
  gate.waitForBuilds(1);
  auto second = ask(keyAt(2), queued);
  cache.reset();
  EXPECT_EQ(running->get_future().get().error().kind, ErrorKind::Cancelled);
  EXPECT_EQ(queued->get_future().get().error().kind, ErrorKind::Cancelled);
  first.reset();  // tickets may outlive their cache
  gate.release();
  pool.reset();
  EXPECT_EQ(builtTiles().size(), 1u);
}

TEST_F(TileCacheTest, APoolThatStopsCancelsWhatWaitsInItsQueue) {
  make(1 << 20);
  gate.hold();
  auto first = cache->getOrBuild(keyAt(1), [](const Result<CachedTilePtr>&) {});
  gate.waitForBuilds(1);
  const auto queued = std::make_shared<Answer>();
  auto second = ask(keyAt(2), queued);
  std::thread stopper([&] { pool->stop(); });
  EXPECT_EQ(queued->get_future().get().error().kind, ErrorKind::Cancelled);
  gate.release();
  stopper.join();
  EXPECT_EQ(get(keyAt(3)).error().kind, ErrorKind::Overloaded);
}

// Many threads ask, drop and wait at random. Whoever keeps a ticket is answered once; whoever drops one is answered at
// most once, and not after the drop has returned unless the answer had begun.
TEST_F(TileCacheTest, RandomRequestsAndDropsFromManyThreadsAreAnsweredExactlyOnce) {
  constexpr std::uint32_t kSeed = 20260;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  make(40 * 1300, 64, 2);
  constexpr int kThreads = 4, kRequests = 400;
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      std::mt19937 random(kSeed + t);
      for (int i = 0; i < kRequests; ++i) {
        auto answers = std::make_shared<std::atomic<int>>(0);
        auto ticket =
            cache->getOrBuild(keyAt(6, random() % 64), [answers](const Result<CachedTilePtr>&) { ++*answers; });
        if (random() % 2 == 0) {
          ticket.reset();
          ASSERT_LE(*answers, 1);
        } else {
          while (*answers == 0) std::this_thread::yield();
          ASSERT_EQ(*answers, 1);
        }
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(cache->stats().bytes, 40u * 1300u);
}

}  // namespace
}  // namespace terrane

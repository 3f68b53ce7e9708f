#include "client/tiles/disk_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace terrane {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_support::TemporaryFolder;
using Bytes = std::vector<std::uint8_t>;

Bytes bytesOf(std::size_t size, int seed) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = static_cast<std::uint8_t>(i * 31 + static_cast<std::size_t>(seed) * 7);
  return bytes;
}

std::string keyOf(int i) { return std::string("/v1/0123456789abcdef/moon/cube/0/").append(std::to_string(i)); }

std::unique_ptr<DiskCache> openCache(const std::string& file, std::size_t budget = 1 << 20) {
  auto cache = DiskCache::open(file, budget);
  EXPECT_TRUE(cache) << cache.error().text();
  return cache ? std::move(*cache) : nullptr;
}

void overwrite(const std::string& file, std::streamoff at, const std::string& text) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(at);
  stream << text;
}

void execute(const std::string& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  sqlite3_close(database);
}

TEST(DiskCache, KeepsContentBetweenRuns) {
  const TemporaryFolder folder;
  const std::string file = folder / "not/yet/there/tiles.sqlite";
  {
    auto cache = openCache(file);
    EXPECT_FALSE(cache->get("a"));
    cache->put("a", bytesOf(5000, 1));
    cache->put("empty", Bytes());
    cache->put("a", bytesOf(300, 2));
  }
  auto cache = openCache(file);
  EXPECT_EQ(cache->get("a"), bytesOf(300, 2)) << "the later content replaces the earlier";
  EXPECT_EQ(cache->get("empty"), Bytes());
  EXPECT_EQ(cache->storedBytes(), 301u + 5u);
  cache->remove("a");
  EXPECT_FALSE(cache->get("a"));
  EXPECT_THAT(cache->notice(), IsEmpty());
}

TEST(DiskCache, StaysWithinItsBudgetAndDropsTheLeastRecentlyUsed) {
  const TemporaryFolder folder;
  auto cache = openCache(folder / "tiles.sqlite", 100'000);
  for (int i = 0; i < 90; ++i) cache->put(keyOf(i), bytesOf(1000, i));
  ASSERT_TRUE(cache->get(keyOf(0))) << "used again: no longer the oldest";
  for (int i = 90; i < 110; ++i) {
    cache->put(keyOf(i), bytesOf(1000, i));
    EXPECT_LE(cache->storedBytes(), 100'000u);
  }
  EXPECT_TRUE(cache->get(keyOf(0)));
  EXPECT_FALSE(cache->get(keyOf(1)));
  EXPECT_FALSE(cache->get(keyOf(2)));
  EXPECT_EQ(cache->get(keyOf(109)), bytesOf(1000, 109));
  EXPECT_GT(cache->storedBytes(), 80'000u) << "no more than needed goes";
}

TEST(DiskCache, LastUseSurvivesARestart) {
  const TemporaryFolder folder;
  const std::string file = folder / "tiles.sqlite";
  {
    auto cache = openCache(file, 100'000);
    for (int i = 0; i < 90; ++i) cache->put(keyOf(i), bytesOf(1000, i));
    ASSERT_TRUE(cache->get(keyOf(0)));
  }
  auto cache = openCache(file, 100'000);
  for (int i = 90; i < 110; ++i) cache->put(keyOf(i), bytesOf(1000, i));
  EXPECT_TRUE(cache->get(keyOf(0)));
  EXPECT_FALSE(cache->get(keyOf(1)));
}

TEST(DiskCache, ThePinnedSceneOutlivesAllTiles) {
  const TemporaryFolder folder;
  auto cache = openCache(folder / "tiles.sqlite", 50'000);
  cache->put("http://127.0.0.1:1/v1/scene.json", bytesOf(500, 7), DiskCache::Keep::Always);
  for (int i = 0; i < 200; ++i) cache->put(keyOf(i), bytesOf(1000, i));
  EXPECT_TRUE(cache->get("http://127.0.0.1:1/v1/scene.json"));
}

TEST(DiskCache, ContentLargerThanTheBudgetIsNotKept) {
  const TemporaryFolder folder;
  auto cache = openCache(folder / "tiles.sqlite", 10'000);
  cache->put("small", bytesOf(10, 1));
  cache->put("large", bytesOf(20'000, 1));
  EXPECT_TRUE(cache->get("small"));
  EXPECT_FALSE(cache->get("large"));
}

TEST(DiskCache, ADamagedFileIsPutAsideAndNothingInItIsLost) {
  const TemporaryFolder folder;
  const std::string file = folder / "tiles.sqlite";
  const std::string rubbish = "this was never a database, or is none any more";
  for (int round = 1; round <= 2; ++round) {
    std::ofstream(file, std::ios::binary) << rubbish << round;
    auto cache = openCache(file);
    ASSERT_TRUE(cache);
    const std::string aside = file + (round == 1 ? ".corrupt" : ".corrupt-2");
    EXPECT_THAT(cache->notice(), HasSubstr(aside));
    std::ifstream kept(aside, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(kept)), {});
    EXPECT_EQ(text, rubbish + std::to_string(round));
    cache->put("a", bytesOf(10, 1));
    EXPECT_TRUE(cache->get("a"));
    cache.reset();
    fs::remove(file);
  }
}

TEST(DiskCache, DamageFoundWhileRunningIsPutAsideToo) {
  const TemporaryFolder folder;
  const std::string file = folder / "tiles.sqlite";
  {
    auto cache = openCache(file);
    for (int i = 0; i < 200; ++i) cache->put(keyOf(i), bytesOf(2000, i));
  }
  // Everything behind the first page: the file opens, its tables do not read.
  const auto size = static_cast<std::streamoff>(fs::file_size(file));
  for (std::streamoff at = 4096; at + 4096 <= size; at += 4096) overwrite(file, at, std::string(4096, '\xff'));
  auto cache = openCache(file);
  ASSERT_TRUE(cache);
  for (int i = 0; i < 200; ++i) EXPECT_FALSE(cache->get(keyOf(i))) << "never wrong bytes";
  cache->put("a", bytesOf(10, 1));
  EXPECT_EQ(cache->get("a"), bytesOf(10, 1));
  EXPECT_THAT(cache->notice(), HasSubstr(".corrupt"));
  EXPECT_TRUE(fs::exists(file + ".corrupt"));
}

TEST(DiskCache, AFlippedBitInContentIsFoundAndTheRowDeleted) {
  const TemporaryFolder folder;
  const std::string file = folder / "tiles.sqlite";
  {
    auto cache = openCache(file);
    cache->put("a", bytesOf(100, 1));
    cache->put("b", bytesOf(100, 2));
  }
  execute(file, "UPDATE media SET content = zeroblob(100) WHERE key = 'a'");
  auto cache = openCache(file);
  EXPECT_FALSE(cache->get("a"));
  EXPECT_EQ(cache->get("b"), bytesOf(100, 2));
  EXPECT_EQ(cache->storedBytes(), 101u);
}

TEST(DiskCache, SomebodyElsesDatabaseIsNotTouched) {
  const TemporaryFolder folder;
  const std::string file = folder / "accounts.sqlite";
  execute(file, "CREATE TABLE accounts(name TEXT); INSERT INTO accounts VALUES('kept')");
  const auto before = fs::last_write_time(file);
  const auto cache = DiskCache::open(file, 1000);
  ASSERT_FALSE(cache);
  EXPECT_EQ(cache.error().kind, ErrorKind::Io);
  EXPECT_EQ(cache.error().field, file);
  EXPECT_EQ(fs::last_write_time(file), before);
  EXPECT_FALSE(fs::exists(file + ".corrupt"));
}

TEST(DiskCache, APlaceThatCannotBeWrittenNamesTheFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  for (const std::string& file : {folder / "file/below.sqlite", folder.path()}) {
    const auto cache = DiskCache::open(file, 1000);
    ASSERT_FALSE(cache) << file;
    EXPECT_EQ(cache.error().kind, ErrorKind::Io);
    EXPECT_EQ(cache.error().field, file);
  }
}

TEST(DiskCache, TwoViewersShareOneFile) {
  const TemporaryFolder folder;
  const std::string file = folder / "tiles.sqlite";
  constexpr int kEach = 150;
  std::atomic<int> wrong{0};
  const auto view = [&](int first) {
    auto cache = openCache(file, 8 << 20);
    if (!cache) return;
    for (int i = 0; i < kEach; ++i) {
      cache->put(keyOf(first + i), bytesOf(500, first + i));
      const auto back = cache->get(keyOf(first + i));
      if (!back || *back != bytesOf(500, first + i)) ++wrong;
    }
  };
  std::thread one([&] { view(0); }), two([&] { view(1000); });
  one.join();
  two.join();
  EXPECT_EQ(wrong, 0);
  auto cache = openCache(file, 8 << 20);
  for (int i = 0; i < kEach; ++i) {
    EXPECT_TRUE(cache->get(keyOf(i)));
    EXPECT_TRUE(cache->get(keyOf(1000 + i)));
  }
  EXPECT_FALSE(fs::exists(file + ".corrupt"));
}

TEST(DiskCache, OneCacheServesManyThreads) {
  const TemporaryFolder folder;
  auto cache = openCache(folder / "tiles.sqlite", 60'000);
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 100; ++i) {
        const int key = (i * 7 + t) % 90;
        if (const auto found = cache->get(keyOf(key)); found && *found != bytesOf(1000, key)) ++wrong;
        cache->put(keyOf(key), bytesOf(1000, key));
        if (i % 17 == 0) cache->remove(keyOf(key));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(cache->storedBytes(), 60'000u);
}

}  // namespace
}  // namespace terrane

// The bytes of many tiles are the same whichever build of the kernels made them, on however many threads, and whatever
// the C library makes of the CPU: its sin, exp, log2, pow change their last bit with fused multiply-add, and Draco
// calls some of them. A child process of this program, with that masked, must come to the same hash.
// TERRANE_HASHED_TILES: how many tiles (a few hundred). golden_tile_test holds a few of them against stored hashes.

#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "server/build/tile_builder.h"
#include "tests/support/child_process.h"
#include "tests/support/grounds.h"
#include "tests/support/ico_points.h"
#include "tests/support/sanitizers.h"

namespace terrane {
namespace {

constexpr std::size_t kDefaultTiles = test::kAddressSanitizer ? 30 : 300;

constexpr unsigned kSeed = 48;

std::size_t hashedTiles() {
  const char* text = std::getenv("TERRANE_HASHED_TILES");
  if (text == nullptr) return kDefaultTiles;
  std::size_t count = 0;
  const auto [end, failure] = std::from_chars(text, text + std::strlen(text), count);
  if (failure != std::errc() || *end != '\0' || count == 0)
    throw std::invalid_argument("TERRANE_HASHED_TILES is no number of tiles: " + std::string(text));
  return count;
}

/// Of both schemes in turn and all their levels, a quarter or more of them at a border of their face.
std::vector<FacePath> tilePaths(std::size_t count) {
  std::mt19937_64 random(kSeed);
  std::vector<FacePath> paths;
  const int finestIco = maxLevel(kMoonRadiusMeters, Scheme::Ico);
  for (std::size_t i = 0; i < count; ++i) {
    const int level = static_cast<int>(i / 2 % (FacePath::kMaxLevel + 1));
    if (i % 2 != 0) {
      paths.push_back(test::randomIcoTile(random, std::min(level, finestIco)));
      continue;
    }
    const std::uint64_t last = (std::uint64_t{1} << level) - 1;
    const auto column = static_cast<std::uint32_t>(random() % 4 == 0 ? last : random() & last);
    const auto row = static_cast<std::uint32_t>(random() & last);
    paths.push_back(FacePath::cubeTile(static_cast<int>(random() % 6), level, column, row));
  }
  return paths;
}

/// One hash of the bytes of all tiles, in the order of their paths.
std::uint64_t hashOfTiles(std::size_t count, SimdPath simd, unsigned threads) {
  const auto made = [&](Scheme scheme, FieldKind field) {
    return TileBuilder(test::bodyOf({scheme, field}), WireSettings{}, simd);
  };
  const std::array builders{made(Scheme::Cube, FieldKind::Lunar), made(Scheme::Ico, FieldKind::Lunar),
                            made(Scheme::Cube, FieldKind::Midpoint), made(Scheme::Ico, FieldKind::Midpoint)};
  const std::vector<FacePath> paths = tilePaths(count);
  std::vector<std::uint64_t> hashes(paths.size());
  std::atomic<std::size_t> next{0};
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < threads; ++i) {
      workers.emplace_back([&] {
        for (std::size_t k = next++; k < paths.size(); k = next++) {
          // Every third of fractal ground.
          const std::size_t builder = (k % 3 == 2 ? 2 : 0) + (paths[k].scheme() == Scheme::Cube ? 0 : 1);
          const Result<BuiltTile> tile = builders[builder].build(paths[k]);
          EXPECT_TRUE(tile.has_value()) << paths[k].text();
          if (tile.has_value()) hashes[k] = XXH3_64bits(tile->glb.data(), tile->glb.size());
        }
      });
    }
  }
  return XXH3_64bits(hashes.data(), hashes.size() * sizeof hashes[0]);
}

/// The control: heights made with the C library's functions, as a field might be written.
std::uint64_t hashOfLibraryField() {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<double> heights;
  for (int i = 0; i < 100'000; ++i) {
    const double x = unit(random), y = unit(random), z = unit(random);
    heights.push_back(std::sin(40 * x) * std::cos(40 * y) + std::exp(z) + std::pow(1.5 + x, y) + std::atan2(y, x));
  }
  return XXH3_64bits(heights.data(), heights.size() * sizeof heights[0]);
}

unsigned processors() { return std::max(1u, std::thread::hardware_concurrency()); }

/// Of this process, on this CPU's own path.
std::uint64_t referenceHash() {
  static const std::uint64_t hash = hashOfTiles(hashedTiles(), bestSimdPath(), processors());
  return hash;
}

constexpr const char* kHashTest = "TileBytes.HaveAHashThatAnotherProcessCanCompare";
constexpr const char* kTilesLine = "hash of tiles ";
constexpr const char* kControlLine = "hash of the control ";

TEST(TileBytes, HaveAHashThatAnotherProcessCanCompare) {
  std::cout << "seed " << kSeed << '\n';
  std::cout << kTilesLine << referenceHash() << '\n' << kControlLine << hashOfLibraryField() << '\n';
  EXPECT_NE(hashOfTiles(31, SimdPath::Default, 1), hashOfTiles(32, SimdPath::Default, 1)) << "it does see a tile";
}

TEST(TileBytes, AreTheSameOnEverySimdPath) {
  for (const SimdPath simd : {SimdPath::Default, SimdPath::V3, SimdPath::V4}) {
    if (simd == bestSimdPath()) continue;
    if (simdPathSupported(simd)) {
      EXPECT_EQ(hashOfTiles(hashedTiles(), simd, processors()), referenceHash());
    } else {
      std::cout << "this CPU has no path " << static_cast<int>(simd) << '\n';
    }
  }
}

TEST(TileBytes, AreTheSameOnOneThreadAndOnFour) {
  const std::size_t count = std::min(hashedTiles(), 10 * kDefaultTiles);
  EXPECT_EQ(hashOfTiles(count, bestSimdPath(), 1), hashOfTiles(count, bestSimdPath(), 4));
}

/// A variable of the environment for as long as this lives.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~EnvironmentVariable() { unsetenv(name_); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  const char* name_;
};

std::string lineAfter(const std::string& text, const std::string& prefix) {
  const std::size_t at = text.find(prefix);
  if (at == std::string::npos) return "none";
  const std::size_t start = at + prefix.size();
  return text.substr(start, text.find('\n', start) - start);
}

TEST(TileBytes, DoNotDependOnTheLibrarysFusedMultiplyAdd) {
  std::string output;
  {
    const EnvironmentVariable mask("GLIBC_TUNABLES", testing_support::kWithoutFma.data());
    testing_support::ChildProcess masked({"/proc/self/exe", std::string("--gtest_filter=") + kHashTest});
    ASSERT_EQ(masked.wait(std::chrono::hours(1)), 0) << masked.output() << masked.errors();
    output = masked.output();
  }
  EXPECT_EQ(lineAfter(output, kTilesLine), std::to_string(referenceHash()));
  const bool controlChanged = lineAfter(output, kControlLine) != std::to_string(hashOfLibraryField());
  std::cout << "control, a field of sin, cos, exp, pow, atan2: " << (controlChanged ? "changed" : "unchanged") << '\n';
  if (!controlChanged) {
    GTEST_SKIP() << "the control shows no difference: this CPU has no FMA, or this C library does not choose by it";
  }
}

}  // namespace
}  // namespace terrane

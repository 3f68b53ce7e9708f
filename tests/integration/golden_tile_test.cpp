// The bytes of tiles: the same on one thread and on eight, on every build of the kernels, and the same as those in
// tests/golden/moon_tiles.txt. Where they change on purpose, raise kGeneratorVersion and write the file anew:
//   TERRANE_WRITE_GOLDEN=1 integration_tests --gtest_filter='GoldenTile.*'
// which refuses while the version is the one that the file already has.

#include <gtest/gtest.h>
#include <xxhash.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "server/build/tile_builder.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

const std::string kGoldenFile = std::string(TERRANE_SOURCE_DIR) + "/tests/golden/moon_tiles.txt";

struct Golden {
  int generatorVersion = 0;
  std::vector<std::string> lines;  ///< "path hash"
};

Golden readGolden() {
  Golden golden;
  std::ifstream file(kGoldenFile);
  std::string line;
  while (std::getline(file, line)) {
    if (line.rfind("generator ", 0) == 0) {
      golden.generatorVersion = std::stoi(line.substr(10));
    } else if (!line.empty() && line.front() != '#') {
      golden.lines.push_back(line);
    }
  }
  return golden;
}

void writeGolden(const std::vector<std::string>& lines) {
  std::ofstream file(kGoldenFile);
  file << "# Tiles of the Moon: path and XXH3 of the GLB. Written by golden_tile_test, which says how.\n";
  file << "generator " << kGeneratorVersion << '\n';
  for (const std::string& line : lines) file << line << '\n';
}

/// All faces, and four tiles of each level down to the cap, borders of faces among them.
std::vector<FacePath> goldenPaths() {
  std::mt19937_64 random(1969);
  std::vector<FacePath> paths;
  for (int face = 0; face < 6; ++face) paths.push_back(FacePath::wholeFace(Scheme::Cube, face));
  for (int level = 1; level <= FacePath::kMaxLevel; ++level) {
    const std::uint64_t last = (std::uint64_t{1} << level) - 1;
    for (int k = 0; k < 4; ++k) {
      const auto column = static_cast<std::uint32_t>(k == 3 ? last : random() & last);
      paths.push_back(FacePath::cubeTile(static_cast<int>(random() % 6), level, column,
                                         static_cast<std::uint32_t>(random() & last)));
    }
  }
  return paths;
}

std::string hashLine(const TileBuilder& builder, const FacePath& path) {
  const Result<BuiltTile> built = builder.build(path);
  if (built.has_error()) return path.text() + " " + built.error().text();
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx",
                static_cast<unsigned long long>(XXH3_64bits(built->glb.data(), built->glb.size())));
  return path.text() + " " + hash;
}

std::vector<std::string> hashesWith(SimdPath simd, unsigned threads) {
  const TileBuilder builder(testMoon(), {}, simd);
  const std::vector<FacePath> paths = goldenPaths();
  std::vector<std::string> lines(paths.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> workers;
  for (unsigned i = 0; i < threads; ++i) {
    workers.emplace_back([&] {
      for (std::size_t k = next++; k < paths.size(); k = next++) lines[k] = hashLine(builder, paths[k]);
    });
  }
  workers.clear();
  return lines;
}

const std::vector<std::string>& reference() {
  static const std::vector<std::string> lines = hashesWith(SimdPath::Default, 1);
  return lines;
}

TEST(GoldenTile, BytesAreTheOnesThisGeneratorVersionAlwaysMade) {
  const Golden golden = readGolden();
  if (std::getenv("TERRANE_WRITE_GOLDEN") != nullptr && golden.lines != reference()) {
    ASSERT_TRUE(golden.lines.empty() || golden.generatorVersion != kGeneratorVersion)
        << "the bytes changed: raise kGeneratorVersion (server/build/tile_builder.h) before writing " << kGoldenFile;
    writeGolden(reference());
    GTEST_SKIP() << "wrote " << kGoldenFile;
  }
  ASSERT_EQ(golden.generatorVersion, kGeneratorVersion)
      << "write " << kGoldenFile << " for this version: see the top of this test";
  ASSERT_EQ(golden.lines.size(), reference().size());
  for (std::size_t i = 0; i < golden.lines.size(); ++i)
    EXPECT_EQ(golden.lines[i], reference()[i]) << "the bytes changed, but kGeneratorVersion did not";
}

TEST(GoldenTile, EightThreadsBuildTheSameBytesAsOne) { EXPECT_EQ(hashesWith(SimdPath::Default, 8), reference()); }

TEST(GoldenTile, EveryBuildOfTheKernelsGivesTheSameBytes) {
  for (const SimdPath simd : {SimdPath::V3, SimdPath::V4}) {
    if (!simdPathSupported(simd)) {
      std::printf("this CPU has no path %d\n", static_cast<int>(simd));
      continue;
    }
    EXPECT_EQ(hashesWith(simd, 2), reference());
  }
}

TEST(GoldenTile, AnotherSeedIsAnotherMoon) {
  // The control: the hashes do see a difference.
  Body other = testMoon();
  other.seed = 1970;
  const TileBuilder builder(other, {}, SimdPath::Default);
  EXPECT_NE(hashLine(builder, goldenPaths()[20]), reference()[20]);
}

}  // namespace
}  // namespace terrane

// The bytes of tiles: the same as those in tests/golden/moon_tiles.txt, on every build. (That they depend on neither
// threads, nor the build of the kernels, nor the C library is tile_bytes_test's.) Where they change on purpose, raise
// kGeneratorVersion and write the file anew:
//   TERRANE_WRITE_GOLDEN=1 integration_tests --gtest_filter='GoldenTile.*'
// which refuses while the version is the one that the file already has.

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

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
      // One after the other: compilers differ in which argument of a call they evaluate first.
      const auto row = static_cast<std::uint32_t>(random() & last);
      paths.push_back(FacePath::cubeTile(static_cast<int>(random() % 6), level, column, row));
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

const std::vector<std::string>& built() {
  static const std::vector<std::string> lines = [] {
    const TileBuilder builder(testMoon(), {}, SimdPath::Default);
    std::vector<std::string> hashes;
    for (const FacePath& path : goldenPaths()) hashes.push_back(hashLine(builder, path));
    return hashes;
  }();
  return lines;
}

TEST(GoldenTile, BytesAreTheOnesThisGeneratorVersionAlwaysMade) {
  const Golden golden = readGolden();
  if (std::getenv("TERRANE_WRITE_GOLDEN") != nullptr && golden.lines != built()) {
    ASSERT_TRUE(golden.lines.empty() || golden.generatorVersion != kGeneratorVersion)
        << "the bytes changed: raise kGeneratorVersion (server/build/tile_builder.h) before writing " << kGoldenFile;
    writeGolden(built());
    GTEST_SKIP() << "wrote " << kGoldenFile;
  }
  ASSERT_EQ(golden.generatorVersion, kGeneratorVersion)
      << "write " << kGoldenFile << " for this version: see the top of this test";
  ASSERT_EQ(golden.lines.size(), built().size());
  for (std::size_t i = 0; i < golden.lines.size(); ++i)
    EXPECT_EQ(golden.lines[i], built()[i]) << "the bytes changed, but kGeneratorVersion did not";
}

TEST(GoldenTile, AnotherSeedIsAnotherMoon) {
  // The control: the hashes do see a difference.
  Body other = testMoon();
  other.seed = 1970;
  const TileBuilder builder(other, {}, SimdPath::Default);
  EXPECT_NE(hashLine(builder, goldenPaths()[20]), built()[20]);
}

}  // namespace
}  // namespace terrane

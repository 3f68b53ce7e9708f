// The bytes of tiles: the same as those in tests/golden, a file for each ground, on every build. (That they depend on
// neither threads, nor the build of the kernels, nor the C library is tile_bytes_test's.) Where they change on purpose,
// raise kGeneratorVersion and write the file anew:
//   TERRANE_WRITE_GOLDEN=1 integration_tests --gtest_filter='*GoldenTile.*'
// which refuses while the version is the one that the file already has.

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

#include "server/build/tile_builder.h"
#include "tests/support/folders.h"
#include "tests/support/grounds.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

std::string goldenFile(const test::Ground& ground) {
  const std::string name = ground.field == FieldKind::Lunar ? "moon" : std::string(fieldRow(ground.field).name);
  return test::sourceFolder() + "/tests/golden/" + name +
         (ground.scheme == Scheme::Cube ? "_tiles.txt" : "_ico_tiles.txt");
}

struct Golden {
  int generatorVersion = 0;
  std::vector<std::string> lines;  ///< "path hash"
};

Golden readGolden(const test::Ground& ground) {
  Golden golden;
  std::ifstream file(goldenFile(ground));
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

void writeGolden(const test::Ground& ground, const std::vector<std::string>& lines) {
  std::ofstream file(goldenFile(ground));
  file << "# Tiles of " << fieldRow(ground.field).name
       << " ground: path and XXH3 of the GLB. Written by golden_tile_test, which says how.\n";
  file << "generator " << kGeneratorVersion << '\n';
  for (const std::string& line : lines) file << line << '\n';
}

/// All faces, and four tiles of each level down to the cap, borders of faces among them.
std::vector<FacePath> cubePaths() {
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

std::vector<FacePath> icoPaths(int maxLevel) {
  std::mt19937_64 random(1969);
  std::vector<FacePath> paths;
  for (int face = 0; face < kIcosahedronFaces; ++face) paths.push_back(FacePath::wholeFace(Scheme::Ico, face));
  for (int level = 1; level <= maxLevel; ++level)
    for (int k = 0; k < 4; ++k) paths.push_back(test::randomIcoTile(random, level));
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

std::vector<std::string> hashLines(const test::Ground& ground) {
  const TileBuilder builder(tiledBy(ground.scheme, testBody(ground.field, kMoonRadiusMeters)), {}, SimdPath::Default);
  std::vector<std::string> lines;
  for (const FacePath& path : ground.scheme == Scheme::Cube ? cubePaths() : icoPaths(builder.info().selection.maxLevel))
    lines.push_back(hashLine(builder, path));
  return lines;
}

class GoldenTile : public testing::TestWithParam<test::Ground> {};
INSTANTIATE_TEST_SUITE_P(Grounds, GoldenTile, test::allGrounds(), test::nameOfGround);

TEST_P(GoldenTile, BytesAreTheOnesThisGeneratorVersionAlwaysMade) {
  const Golden golden = readGolden(GetParam());
  const std::vector<std::string> built = hashLines(GetParam());
  const std::string file = goldenFile(GetParam());
  const bool isOld = golden.generatorVersion != kGeneratorVersion;
  if (std::getenv("TERRANE_WRITE_GOLDEN") != nullptr && (isOld || golden.lines != built)) {
    ASSERT_TRUE(golden.lines.empty() || isOld)
        << "the bytes changed: raise kGeneratorVersion (server/build/tile_builder.h) before writing " << file;
    writeGolden(GetParam(), built);
    GTEST_SKIP() << "wrote " << file;
  }
  ASSERT_FALSE(isOld) << "write " << file << " for this version: see the top of this test";
  ASSERT_EQ(golden.lines.size(), built.size());
  for (std::size_t i = 0; i < golden.lines.size(); ++i)
    EXPECT_EQ(golden.lines[i], built[i]) << "the bytes changed, but kGeneratorVersion did not";
}

TEST(GoldenTileControl, AnotherSeedIsAnotherMoon) {
  // The control: the hashes do see a difference.
  const TileBuilder builder(testMoon(1970), {}, SimdPath::Default);
  EXPECT_NE(hashLine(builder, cubePaths()[20]), readGolden(Scheme::Cube).lines.at(20));
}

}  // namespace
}  // namespace terrane

// Real tiles by a learnt template: libdraco's bytes, and with predictions of its own the same mesh as libdraco reads
// it. TERRANE_DRACO_TILES: how many tiles in all (800).

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>

#include "proto/draco_template.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

using namespace test;

constexpr unsigned kSeed = 71;

constexpr int kDefaultTiles = test::kAddressSanitizer ? 200 : 800;

int tilesInAll() {
  const char* text = std::getenv("TERRANE_DRACO_TILES");
  if (text == nullptr) return kDefaultTiles;
  int count = 0;
  const auto [end, failure] = std::from_chars(text, text + std::strlen(text), count);
  if (failure != std::errc() || *end != '\0' || count <= 0)
    throw std::invalid_argument("TERRANE_DRACO_TILES is no number of tiles: " + std::string(text));
  return count;
}

/// The grid alone, as a tile of a builder that hangs no skirts would be.
TileMesh withoutSkirts(TileMesh mesh, std::size_t gridCount) {
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const auto corners = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(i);
    if (*std::max_element(corners, corners + 3) < gridCount) kept.insert(kept.end(), corners, corners + 3);
  }
  mesh.triangles = std::move(kept);
  mesh.offsets.resize(3 * gridCount);
  mesh.normals.resize(3 * gridCount);
  mesh.gridIndices.resize(gridCount);
  if (!mesh.colors.empty()) mesh.colors.resize(3 * gridCount);
  return mesh;
}

class DracoTiles : public OfScheme {
 protected:
  using Template = std::shared_ptr<const DracoTemplate>;

  static TileMesh part(const FacePath& path, bool skirts) {
    TileMesh whole = mesh(builder(), path).mesh;
    return skirts ? whole : withoutSkirts(std::move(whole), gridVertexCount(GetParam(), 64));
  }
  static Template learn(bool skirts, const DracoSettings& settings) {
    auto learnt = DracoTemplate::learn(part(path("0"), skirts), settings);
    EXPECT_TRUE(learnt.has_value()) << (learnt ? "" : learnt.error().text());
    return learnt ? *learnt : nullptr;
  }
};
INSTANTIATE_TEST_SUITE_P(Grounds, DracoTiles, allGrounds(), nameOfGround);

TEST_P(DracoTiles, HaveTheBytesOfLibdracoAtAllLevels) {
  RecordProperty("seed", kSeed);
  std::mt19937_64 random(kSeed);
  const int ofEach = (tilesInAll() + 7) / 8;  // four grounds, with skirts and without
  for (const bool skirts : {false, true}) {
    const Template learnt = learn(skirts, {});
    ASSERT_NE(learnt, nullptr);
    for (int i = 0; i < ofEach; ++i) {
      const FacePath path = randomTile(random, i % (maxLevel() + 1));
      const TileMesh tile = part(path, skirts);
      ASSERT_TRUE(learnt->fits(tile));
      EXPECT_TRUE(learnt->encode(tile)->bytes == encodeDraco(tile, {})->bytes) << path.text();
    }
  }
}

TEST_P(DracoTiles, HaveTheBytesOfLibdracoAtEverySpeedFromTwoOn) {
  std::mt19937_64 random(kSeed);
  for (int speed = 2; speed <= 10; ++speed) {
    for (const int bits : {8, 10}) {
      const DracoSettings settings{.speed = speed, .normalBits = bits};
      const Template learnt = learn(true, settings);
      ASSERT_NE(learnt, nullptr);
      for (int level = 0; level <= maxLevel(); level += 5) {
        const TileMesh tile = part(randomTile(random, level), true);
        EXPECT_TRUE(learnt->encode(tile)->bytes == encodeDraco(tile, settings)->bytes)
            << "speed " << speed << ", " << bits << " bits, level " << level;
      }
    }
  }
}

TEST_P(DracoTiles, AreReadExactlyWithPredictionsOfTheirOwn) {
  std::mt19937_64 random(kSeed);
  for (const DracoPrediction prediction : {DracoPrediction::Parallelogram, DracoPrediction::MultiParallelogram}) {
    for (const DracoNormals normals : {DracoNormals::Delta, DracoNormals::Geometric}) {
      const DracoSettings settings{.prediction = prediction, .normals = normals};
      const Template learnt = learn(true, settings);
      ASSERT_NE(learnt, nullptr);
      for (int level = 0; level <= maxLevel(); level += 3) {
        const TileMesh tile = part(randomTile(random, level), true);
        const DracoBuffer stock = encodeDraco(tile, settings).value(), ours = learnt->encode(tile).value();
        const DracoAttributeIds ids{stock.positionId, stock.normalId, stock.colorId, stock.gridId};
        const Result<TileMesh> expected = decodeDraco(stock.bytes, ids, {}), actual = decodeDraco(ours.bytes, ids, {});
        ASSERT_TRUE(expected.has_value() && actual.has_value()) << "level " << level;
        EXPECT_TRUE(actual->offsets == expected->offsets && actual->normals == expected->normals &&
                    actual->colors == expected->colors && actual->gridIndices == expected->gridIndices &&
                    actual->triangles == expected->triangles)
            << "level " << level;
      }
    }
  }
}

}  // namespace
}  // namespace terrane

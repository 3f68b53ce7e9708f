// Built tiles of every level, read by a reader that knows their kind: the meshes that libdraco's decoder gives.

#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <vector>

#include "proto/draco_reader.h"
#include "proto/gltf_tile.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

using namespace test;

constexpr unsigned kSeed = 65;

class TilesReadQuickly : public OfScheme {};
INSTANTIATE_TEST_SUITE_P(Grounds, TilesReadQuickly, allGrounds(), nameOfGround);

std::vector<std::uint32_t> bitsOf(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

TEST_P(TilesReadQuickly, AreTheSameToTheLastBitAtEveryLevel) {
  RecordProperty("seed", kSeed);
  std::mt19937_64 random(kSeed);
  DracoReader reader;
  std::uint64_t tiles = 0;
  for (int level = 0; level <= maxLevel(); ++level) {
    const FacePath path = randomTile(random, level);
    const auto glb = builder().build(path).value().glb;
    const Tile expected = decodeTile(glb).value(), tile = decodeTile(glb, reader).value();
    EXPECT_TRUE(tile.metadata.path == expected.metadata.path && tile.metadata.origin == expected.metadata.origin);
    EXPECT_EQ(tile.mesh.offsets, expected.mesh.offsets) << path.text();
    EXPECT_EQ(bitsOf(tile.mesh.normals), bitsOf(expected.mesh.normals)) << path.text();
    EXPECT_EQ(tile.mesh.colors, expected.mesh.colors) << path.text();
    EXPECT_EQ(tile.mesh.gridIndices, expected.mesh.gridIndices) << path.text();
    EXPECT_EQ(tile.mesh.triangles, expected.mesh.triangles) << path.text();
    ++tiles;
  }
  EXPECT_EQ(reader.counts().quick, tiles - 1) << "all tiles of a body are of one kind";
}

}  // namespace
}  // namespace terrane

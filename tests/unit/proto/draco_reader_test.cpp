// The reader that knows kinds of streams against libdraco's decoder: equal meshes, bit for bit, and equal errors.

#include "proto/draco_reader.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <string>

#include "tests/unit/proto/kinds_of_data.h"
#include "tests/unit/proto/sample_tile.h"

namespace terrane::test {
namespace {

constexpr unsigned kSeed = 23;

TileMesh sampleMesh(int cells, bool skirts = true, bool colors = true, std::uint32_t seed = 1) {
  return sampleTile({.cellsPerEdge = cells, .skirts = skirts, .colors = colors, .seed = seed}).mesh;
}

DracoAttributeIds idsOf(const DracoBuffer& buffer) {
  return {buffer.positionId, buffer.normalId, buffer.colorId, buffer.gridId};
}

std::vector<std::uint32_t> bitsOf(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

::testing::AssertionResult sameBits(const Result<TileMesh>& expected, const Result<TileMesh>& actual) {
  const auto differ = [](const char* what) { return ::testing::AssertionFailure() << what << " differ"; };
  if (expected.has_value() != actual.has_value()) return differ("mesh and error");
  if (!expected) {
    if (expected.error().kind != actual.error().kind) return differ("kinds of error");
    return expected.error().text() == actual.error().text() ? ::testing::AssertionSuccess() : differ("errors");
  }
  if (expected->offsets != actual->offsets) return differ("offsets");
  if (bitsOf(expected->normals) != bitsOf(actual->normals)) return differ("normals");
  if (expected->colors != actual->colors) return differ("colours");
  if (expected->gridIndices != actual->gridIndices) return differ("grid indices");
  if (expected->triangles != actual->triangles) return differ("triangles");
  return ::testing::AssertionSuccess();
}

/// All kinds of data on the model's triangles, after one tile was learnt from.
void expectMeshesOfLibdraco(const TileMesh& model, const DracoSettings& settings, const std::string& kind) {
  DracoReader reader;
  std::uint64_t streams = 0;
  for (const auto& [name, mesh] : test::kindsOfData(model, kSeed)) {
    const auto stream = encodeDraco(mesh, settings);
    ASSERT_TRUE(stream.has_value()) << stream.error().text();
    const auto expected = decodeDraco(stream->bytes, idsOf(*stream), {});
    ASSERT_TRUE(expected.has_value()) << expected.error().text();
    EXPECT_TRUE(sameBits(expected, reader.decode(stream->bytes, idsOf(*stream), {})))
        << name << ", " << kind << ", speed " << settings.speed << ", " << settings.normalBits << " bits, seed "
        << kSeed;
    ++streams;
  }
  EXPECT_EQ(reader.counts().quick, streams - 1) << kind << ", speed " << settings.speed << ", " << settings.normalBits;
  EXPECT_EQ(reader.counts().byLibdraco, 1u) << "the first teaches";
}

TEST(DracoReader, GivesTheMeshesOfLibdracoForEveryKindOfTile) {
  RecordProperty("seed", kSeed);
  for (const FacePath& path : kSamplePaths)
    for (const int cells : {1, 2, 8, 64, 128})
      for (const bool skirts : {false, true})
        for (const bool colors : {false, true})
          expectMeshesOfLibdraco(
              sampleTile({.path = path, .cellsPerEdge = cells, .skirts = skirts, .colors = colors}).mesh, {},
              path.text() + ", " + std::to_string(cells) + " cells");
}

TEST(DracoReader, GivesTheMeshesOfLibdracoInEverySetting) {
  RecordProperty("seed", kSeed);
  for (const FacePath& path : kSamplePaths)
    for (int speed = 0; speed <= 10; ++speed)
      for (const int bits : {2, 3, 7, 8, 10, 16})
        expectMeshesOfLibdraco(sampleTile({.path = path, .cellsPerEdge = 16}).mesh, {speed, bits}, path.text());
}

TEST(DracoReader, GivesTheMeshesOfLibdracoInTheOtherWayToCodeConnectivity) {
  RecordProperty("seed", kSeed);
  // Below speed 5 the symbols of larger meshes are coded by valence.
  for (const FacePath& path : kSamplePaths)
    for (const int speed : {0, 1, 3, 4})
      expectMeshesOfLibdraco(sampleTile({.path = path}).mesh, {speed, 8}, path.text());
}

/// Where a stream's values begin: streams of other data have all before in common.
std::size_t headBytes(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

/// A reader that knows the kind, and a stream of that kind.
struct Known {
  DracoReader reader;
  DracoBuffer stream;
  std::size_t head = 0;

  explicit Known(int speed) {
    const DracoSettings settings{.speed = speed, .normalBits = 8};
    const DracoBuffer other = encodeDraco(sampleMesh(8, true, true, 2), settings).value();
    stream = encodeDraco(sampleMesh(8), settings).value();
    head = headBytes(stream.bytes, other.bytes);
    (void)reader.decode(other.bytes, idsOf(other), {}).value();
  }
  ::testing::AssertionResult agrees(std::span<const std::uint8_t> bytes) {
    return sameBits(decodeDraco(bytes, idsOf(stream), {}), reader.decode(bytes, idsOf(stream), {}));
  }
};

constexpr int kSpeeds[] = {0, 1, 2, 4, 7, 10};  // all methods that libdraco's encoder chooses

TEST(DracoReader, CutAnywhereItAnswersAsLibdracoDoes) {
  for (const int speed : kSpeeds) {
    Known known(speed);
    for (std::size_t length = 0; length < known.stream.bytes.size(); ++length)
      ASSERT_TRUE(known.agrees(std::span(known.stream.bytes).first(length))) << "speed " << speed << ", " << length;
    EXPECT_EQ(known.reader.counts().quick, 0u) << "no cut stream is read";
    EXPECT_TRUE(known.agrees(known.stream.bytes));
    EXPECT_EQ(known.reader.counts().quick, 1u);
  }
}

TEST(DracoReader, DamagedValuesGiveWhatLibdracoGives) {
  for (const int speed : kSpeeds) {
    Known known(speed);
    constexpr unsigned kStreams = 400;
    for (unsigned seed = 0; seed < kStreams; ++seed) {
      std::mt19937 random(seed);
      std::vector<std::uint8_t> bytes = known.stream.bytes;
      for (auto flips = 1 + random() % 3; flips > 0; --flips)
        bytes[known.head + random() % (bytes.size() - known.head)] ^= static_cast<std::uint8_t>(1u << random() % 8);
      ASSERT_TRUE(known.agrees(bytes)) << "speed " << speed << ", seed " << seed;
    }
    const auto [quick, byLibdraco] = known.reader.counts();
    EXPECT_GT(quick, kStreams / 100) << "hardly a damaged stream was read here: the test tests libdraco against itself";
    EXPECT_GT(byLibdraco, kStreams / 100);
  }
}

TEST(DracoReader, EveryByteChangedGivesWhatLibdracoGives) {
  for (const int speed : kSpeeds) {
    Known known(speed);
    for (std::size_t at = 0; at < known.stream.bytes.size(); ++at)
      for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
        std::vector<std::uint8_t> bytes = known.stream.bytes;
        bytes[at] = static_cast<std::uint8_t>(value);
        ASSERT_TRUE(known.agrees(bytes)) << "speed " << speed << ", byte " << at << " is " << value;
      }
  }
}

TEST(DracoReader, AnotherTailOrMoreBytesGiveWhatLibdracoGives) {
  Known known(7);
  std::vector<std::uint8_t> longer = known.stream.bytes;
  longer.insert(longer.end(), 100, 0xFF);
  EXPECT_TRUE(known.agrees(longer));
  EXPECT_EQ(known.reader.counts().quick, 1u) << "what follows is not looked at";
  // Positions' origin, range and bits, then the normals' bits.
  constexpr std::size_t kTailBytes = 18;
  for (std::size_t at = known.stream.bytes.size() - kTailBytes; at < known.stream.bytes.size(); ++at) {
    std::vector<std::uint8_t> bytes = known.stream.bytes;
    bytes[at] ^= 0x80;
    EXPECT_TRUE(known.agrees(bytes)) << "byte " << at;
  }
  EXPECT_EQ(known.reader.counts().quick, 1u);
}

TEST(DracoReader, KeepsToLimitsAndToTheAttributesThatWereAnnounced) {
  Known known(7);
  const auto& bytes = known.stream.bytes;
  const DracoAttributeIds ids = idsOf(known.stream);
  const DecodeLimits exact{known.stream.vertexCount, known.stream.triangleCount, bytes.size()};
  EXPECT_TRUE(known.reader.decode(bytes, ids, exact).has_value());
  for (const DecodeLimits& limits : {DecodeLimits{exact.maxVertices - 1, exact.maxTriangles, exact.maxBytes},
                                     DecodeLimits{exact.maxVertices, exact.maxTriangles - 1, exact.maxBytes},
                                     DecodeLimits{exact.maxVertices, exact.maxTriangles, exact.maxBytes - 1}}) {
    EXPECT_EQ(known.reader.decode(bytes, ids, limits).error().kind, ErrorKind::TooLarge);
  }
  for (const DracoAttributeIds& other : {DracoAttributeIds{ids.position, ids.normal, -1, ids.grid},
                                         DracoAttributeIds{ids.normal, ids.position, ids.color, ids.grid},
                                         DracoAttributeIds{ids.position, ids.normal, ids.grid, ids.color},
                                         DracoAttributeIds{ids.position, ids.normal, ids.color, -1}}) {
    EXPECT_TRUE(sameBits(decodeDraco(bytes, other, {}), known.reader.decode(bytes, other, {})));
    EXPECT_FALSE(known.reader.decode(bytes, other, {}).has_value());
  }
}

TEST(DracoReader, ForgetsTheKindThatWasNotAskedForLongest) {
  DracoReader reader;
  std::vector<DracoBuffer> streams;
  for (int cells = 1; cells <= static_cast<int>(DracoReader::kMostKinds) + 1; ++cells)
    streams.push_back(encodeDraco(sampleMesh(cells), {}).value());
  const auto isQuick = [&](const DracoBuffer& stream) {
    const auto before = reader.counts().quick;
    EXPECT_TRUE(sameBits(decodeDraco(stream.bytes, idsOf(stream), {}), reader.decode(stream.bytes, idsOf(stream), {})));
    return reader.counts().quick > before;
  };
  for (std::size_t i = 0; i < DracoReader::kMostKinds; ++i) EXPECT_FALSE(isQuick(streams[i])) << "unknown yet";
  for (std::size_t i = 0; i < DracoReader::kMostKinds; ++i) EXPECT_TRUE(isQuick(streams[i]));
  EXPECT_TRUE(isQuick(streams[0])) << "now the second is the one to go";
  EXPECT_FALSE(isQuick(streams.back()));
  EXPECT_TRUE(isQuick(streams[0]));
  EXPECT_FALSE(isQuick(streams[1]));
}

}  // namespace
}  // namespace terrane::test

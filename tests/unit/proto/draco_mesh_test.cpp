#include "proto/draco_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "tests/unit/proto/sample_tile.h"

namespace terrane::test {
namespace {

TileMesh sampleMesh(int cells, bool skirts = true, bool colors = true) {
  return sampleTile({.cellsPerEdge = cells, .skirts = skirts, .colors = colors}).mesh;
}

DracoAttributeIds idsOf(const DracoBuffer& buffer) {
  return {buffer.positionId, buffer.normalId, buffer.colorId, buffer.gridId};
}

/// Longest difference between a unit normal and what it decodes to. A rounded octahedral coordinate is off by half of
/// 1/c, c = 2^(bits-1) - 1 steps from centre to rim; the third follows from the two, and where it would become negative
/// one of them gives way by a whole step; normalising stretches by sqrt(3) at most: sqrt(3) sqrt(2^2 + 1 + 1) / 2
/// = 2.13, and as much again for giving way.
double octahedralError(int bits) { return 3.2 / (std::exp2(bits - 1) - 1); }

TEST(DracoMesh, RoundTripKeepsEveryInteger) {
  for (const int cells : {1, 2, 8, 64, 128})
    for (const bool skirts : {false, true})
      for (const bool colors : {false, true}) {
        const TileMesh mesh = sampleMesh(cells, skirts, colors);
        const auto encoded = encodeDraco(mesh, {});
        ASSERT_TRUE(encoded.has_value()) << encoded.error().text();
        EXPECT_EQ(encoded->vertexCount, mesh.vertexCount());
        EXPECT_EQ(encoded->triangleCount, mesh.triangles.size() / 3);
        const auto decoded = decodeDraco(encoded->bytes, idsOf(*encoded), {});
        ASSERT_TRUE(decoded.has_value()) << decoded.error().text();
        EXPECT_TRUE(sameMesh(mesh, *decoded, octahedralError(8)))
            << cells << " cells, skirts " << skirts << ", colours " << colors;
      }
}

TEST(DracoMesh, AnyOffsetsColoursAndGridIndicesAreExactAtEverySpeed) {
  constexpr unsigned kSeed = 3;
  std::mt19937 random(kSeed);
  for (int speed = 0; speed <= 10; ++speed) {
    TileMesh mesh = sampleMesh(16);
    for (auto& offset : mesh.offsets) offset = static_cast<std::uint16_t>(random() >> 16);
    for (auto& color : mesh.colors) color = static_cast<std::uint8_t>(random() >> 24);
    std::shuffle(mesh.gridIndices.begin(), mesh.gridIndices.end(), random);
    mesh.offsets.front() = 0;
    mesh.offsets.back() = 65535;
    const auto encoded = encodeDraco(mesh, {.speed = speed, .normalBits = 8});
    ASSERT_TRUE(encoded.has_value()) << encoded.error().text();
    const auto decoded = decodeDraco(encoded->bytes, idsOf(*encoded), {});
    ASSERT_TRUE(decoded.has_value()) << decoded.error().text();
    EXPECT_TRUE(sameMesh(mesh, *decoded, octahedralError(8))) << "speed " << speed << ", seed " << kSeed;
  }
}

TEST(DracoMesh, NormalsStayWithinTheOctahedralBound) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  std::normal_distribution<float> gauss;
  for (int bits = 4; bits <= 14; ++bits) {
    TileMesh mesh = sampleMesh(64);
    for (std::size_t i = 0; i < mesh.normals.size(); i += 3) {
      float n[3] = {gauss(random), gauss(random), gauss(random)};
      if (i % 9 == 0) n[random() % 3] = 0;  // where the octahedron folds
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (std::size_t c = 0; c < 3; ++c) mesh.normals[i + c] = n[c] / length;
    }
    const auto encoded = encodeDraco(mesh, {.speed = 7, .normalBits = bits});
    ASSERT_TRUE(encoded.has_value()) << encoded.error().text();
    const auto decoded = decodeDraco(encoded->bytes, idsOf(*encoded), {});
    ASSERT_TRUE(decoded.has_value()) << decoded.error().text();
    EXPECT_TRUE(sameMesh(mesh, *decoded, octahedralError(bits))) << bits << " bits, seed " << kSeed;
    EXPECT_FALSE(sameMesh(mesh, *decoded, octahedralError(bits) / 4))
        << "the bound is far from the error: " << bits << " bits";
  }
}

TEST(DracoMesh, EncodingTwiceGivesTheSameBytes) {
  const TileMesh mesh = sampleMesh(64);
  EXPECT_EQ(encodeDraco(mesh, {})->bytes, encodeDraco(mesh, {})->bytes);
}

TEST(DracoMesh, ConnectivityDoesNotDependOnTheData) {
  TileMesh mesh = sampleMesh(16), flat = mesh;
  std::fill(flat.offsets.begin(), flat.offsets.end(), std::uint16_t{0});
  std::fill(flat.colors.begin(), flat.colors.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < flat.normals.size(); ++i) flat.normals[i] = i % 3 == 2 ? 1.0f : 0.0f;
  const auto a = encodeDraco(mesh, {}), b = encodeDraco(flat, {});
  ASSERT_TRUE(a.has_value() && b.has_value());
  const auto decodedA = decodeDraco(a->bytes, idsOf(*a), {}), decodedB = decodeDraco(b->bytes, idsOf(*b), {});
  ASSERT_TRUE(decodedA.has_value() && decodedB.has_value());
  EXPECT_EQ(decodedB->vertexCount(), flat.vertexCount()) << "equal points must not be merged";
  EXPECT_EQ(decodedA->triangles, decodedB->triangles);
  EXPECT_EQ(decodedA->gridIndices, decodedB->gridIndices);
}

TEST(DracoMesh, EncoderRefusesWhatWouldNotDecodeToItself) {
  const auto fieldAfter = [](auto change) {
    TileMesh mesh = sampleMesh(4);
    change(mesh);
    const auto encoded = encodeDraco(mesh, {});
    return encoded ? std::string("accepted") : encoded.error().field;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.offsets.pop_back(); }), "offsets");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.normals.push_back(0); }), "normals");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.colors.pop_back(); }), "colors");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.triangles.pop_back(); }), "triangles");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.triangles.clear(); }), "triangles");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.triangles[7] = static_cast<std::uint32_t>(m.vertexCount()); }), "triangles");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.triangles[1] = m.triangles[0]; }), "triangles");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.triangles.resize(3); }), "triangles") << "vertices without triangle";
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m = {}; }), "gridIndices");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { std::fill_n(m.normals.begin(), 3, 0.0f); }), "normals");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.normals[4] = kNan; }), "normals");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.normals[4] = kInfinity; }), "normals");
  EXPECT_EQ(fieldAfter([](TileMesh& m) { m.normals[4] = std::numeric_limits<float>::max(); }), "normals");
  EXPECT_EQ(encodeDraco(sampleMesh(4), {.speed = 11, .normalBits = 8}).error().field, "speed");
  EXPECT_EQ(encodeDraco(sampleMesh(4), {.speed = 7, .normalBits = 0}).error().field, "normalBits");
}

TEST(DracoMesh, DecoderNamesLimitsBeforeItDecodes) {
  const auto encoded = encodeDraco(sampleMesh(16), {});
  ASSERT_TRUE(encoded.has_value());
  const auto kindWithin = [&](const DecodeLimits& limits) {
    const auto decoded = decodeDraco(encoded->bytes, idsOf(*encoded), limits);
    return decoded ? ErrorKind::Internal : decoded.error().kind;
  };
  DecodeLimits exact{encoded->vertexCount, encoded->triangleCount, encoded->bytes.size()};
  EXPECT_EQ(kindWithin(exact), ErrorKind::Internal) << "a mesh at the limits is read";
  EXPECT_EQ(kindWithin({exact.maxVertices - 1, exact.maxTriangles, exact.maxBytes}), ErrorKind::TooLarge);
  EXPECT_EQ(kindWithin({exact.maxVertices, exact.maxTriangles - 1, exact.maxBytes}), ErrorKind::TooLarge);
  EXPECT_EQ(kindWithin({exact.maxVertices, exact.maxTriangles, exact.maxBytes - 1}), ErrorKind::TooLarge);
}

TEST(DracoMesh, MoreBytesThanItsVerticesCanNeedAreRefused) {
  // A table of 64 symbols costs a hostile byte, so that bytes must be bounded by what they may decode to.
  const auto encoded = encodeDraco(sampleMesh(8), {});
  ASSERT_TRUE(encoded.has_value());
  std::vector<std::uint8_t> bytes = encoded->bytes;
  const std::size_t most = kMaxDracoBytesBesides + kMaxDracoBytesPerVertex * encoded->vertexCount;
  bytes.resize(most, 0xFF);
  EXPECT_TRUE(decodeDraco(bytes, idsOf(*encoded), {}).has_value());
  bytes.push_back(0xFF);
  EXPECT_EQ(decodeDraco(bytes, idsOf(*encoded), {}).error().kind, ErrorKind::Malformed);
}

TEST(DracoMesh, NoiseStaysWellBelowTheMostBytesThatADecoderTakes) {
  constexpr unsigned kSeed = 17;
  std::mt19937 random(kSeed);
  std::normal_distribution<float> gauss;
  TileMesh mesh = sampleMesh(64);
  for (auto& offset : mesh.offsets) offset = static_cast<std::uint16_t>(random() >> 16);
  for (auto& color : mesh.colors) color = static_cast<std::uint8_t>(random() >> 24);
  for (auto& component : mesh.normals) component = gauss(random);
  std::shuffle(mesh.gridIndices.begin(), mesh.gridIndices.end(), random);
  for (const int speed : {0, 7, 10}) {
    const auto encoded = encodeDraco(mesh, {.speed = speed, .normalBits = 16});
    ASSERT_TRUE(encoded.has_value()) << encoded.error().text();
    EXPECT_LT(encoded->bytes.size(), kMaxDracoBytesBesides + 16 * mesh.vertexCount()) << "speed " << speed;
    EXPECT_TRUE(decodeDraco(encoded->bytes, idsOf(*encoded), {}).has_value());
  }
}

TEST(DracoMesh, DecoderRefusesAttributesThatWereNotAnnounced) {
  const auto encoded = encodeDraco(sampleMesh(4), {});
  ASSERT_TRUE(encoded.has_value());
  const DracoAttributeIds ids = idsOf(*encoded);
  EXPECT_TRUE(decodeDraco(encoded->bytes, ids, {}).has_value());
  EXPECT_FALSE(decodeDraco(encoded->bytes, {ids.position, ids.normal, -1, ids.grid}, {}).has_value()) << "one too many";
  EXPECT_FALSE(decodeDraco(encoded->bytes, {ids.position, ids.normal, ids.color, -1}, {}).has_value());
  EXPECT_FALSE(decodeDraco(encoded->bytes, {ids.normal, ids.position, ids.color, ids.grid}, {}).has_value())
      << "types exchanged";
  EXPECT_FALSE(decodeDraco(encoded->bytes, {ids.position, ids.normal, ids.grid, ids.color}, {}).has_value());
  EXPECT_FALSE(decodeDraco(encoded->bytes, {ids.position, ids.normal, ids.color, 31}, {}).has_value());
}

TEST(DracoMesh, CutAnywhereItIsAnError) {
  const auto encoded = encodeDraco(sampleMesh(8), {});
  ASSERT_TRUE(encoded.has_value());
  for (std::size_t length = 0; length < encoded->bytes.size(); ++length) {
    const auto decoded = decodeDraco(std::span(encoded->bytes).first(length), idsOf(*encoded), {});
    EXPECT_FALSE(decoded.has_value()) << length << " of " << encoded->bytes.size();
  }
}

/// Whatever comes out of hostile bytes must be a mesh that a renderer can trust.
void expectSound(const TileMesh& mesh, const DecodeLimits& limits) {
  ASSERT_LE(mesh.vertexCount(), limits.maxVertices);
  ASSERT_EQ(mesh.offsets.size(), 3 * mesh.vertexCount());
  ASSERT_EQ(mesh.normals.size(), 3 * mesh.vertexCount());
  ASSERT_TRUE(mesh.colors.empty() || mesh.colors.size() == 3 * mesh.vertexCount());
  ASSERT_LE(mesh.triangles.size(), 3 * static_cast<std::size_t>(limits.maxTriangles));
  for (const std::uint32_t index : mesh.triangles) ASSERT_LT(index, mesh.vertexCount());
  for (const float component : mesh.normals) ASSERT_TRUE(std::abs(component) <= 1.01f);
}

TEST(DracoMesh, DamagedBytesGiveAnErrorOrASoundMesh) {
  const auto encoded = encodeDraco(sampleMesh(8), {});
  ASSERT_TRUE(encoded.has_value());
  int survived = 0;
  for (unsigned seed = 0; seed < 10000; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> bytes = encoded->bytes;
    for (auto flips = 1 + random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    const auto decoded = decodeDraco(bytes, idsOf(*encoded), {});
    if (!decoded) continue;
    ++survived;
    ASSERT_NO_FATAL_FAILURE(expectSound(*decoded, {})) << "seed " << seed;
  }
  EXPECT_GT(survived, 0) << "the damage never got past the header: the test tests nothing";
}

TEST(DracoMesh, LyingCountsAreRefused) {
  const auto encoded = encodeDraco(sampleMesh(8), {});
  ASSERT_TRUE(encoded.has_value());
  constexpr std::size_t kCountsBegin = 12;  // two varints of vertices and triangles
  for (const std::uint32_t lie : {0u, 1u, 2u, 1000u, 32768u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu}) {
    for (std::size_t which = 0; which < 5; ++which) {
      std::vector<std::uint8_t> bytes(encoded->bytes.begin(), encoded->bytes.begin() + kCountsBegin);
      std::size_t at = kCountsBegin;
      for (std::size_t field = 0; field < 5; ++field) {
        const std::size_t begin = at;
        while (encoded->bytes[at++] >= 0x80) {
        }
        if (field == which) {
          for (std::uint32_t rest = lie;; rest >>= 7) {
            bytes.push_back(static_cast<std::uint8_t>((rest & 0x7Fu) | (rest >= 0x80 ? 0x80u : 0u)));
            if (rest < 0x80) break;
          }
        } else {
          bytes.insert(bytes.end(), encoded->bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                       encoded->bytes.begin() + static_cast<std::ptrdiff_t>(at));
        }
      }
      bytes.insert(bytes.end(), encoded->bytes.begin() + static_cast<std::ptrdiff_t>(at), encoded->bytes.end());
      if (bytes == encoded->bytes) continue;
      EXPECT_FALSE(decodeDraco(bytes, idsOf(*encoded), {}).has_value()) << "field " << which << " says " << lie;
    }
  }
}

}  // namespace
}  // namespace terrane::test

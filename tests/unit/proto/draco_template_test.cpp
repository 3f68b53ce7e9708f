// The learnt encoder against libdraco's own, byte for byte.

#include "proto/draco_template.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "tests/support/sanitizers.h"
#include "tests/unit/proto/kinds_of_data.h"
#include "tests/unit/proto/sample_tile.h"

namespace terrane::test {
namespace {

constexpr unsigned kSeed = 11;

const std::vector<int> kCells = kAddressSanitizer ? std::vector{1, 2, 8, 64} : std::vector{1, 2, 8, 64, 128};

TileMesh sampleMesh(int cells, bool skirts = true, bool colors = true) {
  return sampleTile({.cellsPerEdge = cells, .skirts = skirts, .colors = colors}).mesh;
}

/// Of the model's kind of tile.
void expectBytesOfLibdraco(const TileMesh& model, const std::string& kind) {
  const auto learnt = DracoTemplate::learn(model, {});
  ASSERT_TRUE(learnt.has_value()) << kind << ": " << learnt.error().text();
  for (const auto& [name, mesh] : test::kindsOfData(model, kSeed)) {
    const auto expected = encodeDraco(mesh, {}), actual = (*learnt)->encode(mesh);
    ASSERT_TRUE(expected.has_value() && actual.has_value()) << name;
    EXPECT_TRUE(actual->bytes == expected->bytes) << name << ", " << kind << ", seed " << kSeed;
    EXPECT_EQ(actual->vertexCount, expected->vertexCount);
    EXPECT_EQ(actual->triangleCount, expected->triangleCount);
    EXPECT_EQ(actual->colorId, expected->colorId);
    EXPECT_EQ(actual->gridId, expected->gridId);
  }
}

TEST(DracoTemplate, GivesTheBytesOfLibdraco) {
  RecordProperty("seed", kSeed);
  for (const FacePath& path : kSamplePaths)
    for (const int cells : kCells)
      for (const bool skirts : {false, true})
        for (const bool colors : {false, true})
          expectBytesOfLibdraco(
              sampleTile({.path = path, .cellsPerEdge = cells, .skirts = skirts, .colors = colors}).mesh,
              path.text() + ", " + std::to_string(cells) + " cells");
}

TEST(DracoTemplate, GivesTheBytesOfLibdracoInEverySettingItTakes) {
  const TileMesh model = sampleMesh(16);
  for (int speed = 0; speed <= 10; ++speed) {
    for (const int bits : {2, 7, 8, 10, 16}) {
      const DracoSettings settings{.speed = speed, .normalBits = bits};
      const auto learnt = DracoTemplate::learn(model, settings);
      EXPECT_EQ(learnt.has_value(), speed >= 2) << "speed " << speed << ", " << bits << " bits";
      if (!learnt) continue;
      for (const auto& [name, mesh] : test::kindsOfData(model, kSeed))
        EXPECT_TRUE((*learnt)->encode(mesh)->bytes == encodeDraco(mesh, settings)->bytes)
            << name << ", speed " << speed << ", " << bits << " bits, seed " << kSeed;
    }
  }
}

/// Every choice of predictions that is not libdraco's at the speed.
std::vector<DracoSettings> settingsOfTheirOwn() {
  std::vector<DracoSettings> all;
  for (const int speed : {0, 3, 4, 7, 10})
    for (const DracoPrediction prediction : {DracoPrediction::Parallelogram, DracoPrediction::MultiParallelogram})
      for (const DracoNormals normals : {DracoNormals::Delta, DracoNormals::Geometric})
        for (const int bits : {8, 10, 16}) all.push_back({speed, bits, prediction, normals});
  return all;
}

TEST(DracoTemplate, LibdracoReadsPredictionsOfTheirOwnExactly) {
  for (const FacePath& path : kSamplePaths) {
    for (const bool skirts : {false, true}) {
      const TileMesh model = sampleTile({.path = path, .cellsPerEdge = 16, .skirts = skirts}).mesh;
      for (const DracoSettings& settings : settingsOfTheirOwn()) {
        const auto learnt = DracoTemplate::learn(model, settings);
        ASSERT_TRUE(learnt.has_value()) << learnt.error().text();
        for (const auto& [name, mesh] : test::kindsOfData(model, kSeed)) {
          const DracoBuffer stock = encodeDraco(mesh, settings).value(), ours = (*learnt)->encode(mesh).value();
          const DracoAttributeIds ids{stock.positionId, stock.normalId, stock.colorId, stock.gridId};
          const TileMesh expected = decodeDraco(stock.bytes, ids, {}).value();
          const Result<TileMesh> actual = decodeDraco(ours.bytes, ids, {});
          ASSERT_TRUE(actual.has_value()) << name << ": " << actual.error().text();
          EXPECT_TRUE(actual->offsets == expected.offsets && actual->normals == expected.normals &&
                      actual->colors == expected.colors && actual->gridIndices == expected.gridIndices &&
                      actual->triangles == expected.triangles)
              << name << ", speed " << settings.speed << ", " << settings.normalBits << " bits, seed " << kSeed;
        }
      }
    }
  }
}

TEST(DracoTemplate, WritesIntoMemoryThatIsThere) {
  const TileMesh mesh = sampleMesh(16);
  const auto learnt = DracoTemplate::learn(mesh, {});
  ASSERT_TRUE(learnt.has_value());
  DracoBuffer buffer;
  ASSERT_TRUE((*learnt)->encodeInto(mesh, buffer).has_value());
  const std::vector<std::uint8_t> first = buffer.bytes;
  const std::uint8_t* memory = buffer.bytes.data();
  ASSERT_TRUE((*learnt)->encodeInto(mesh, buffer).has_value());
  EXPECT_EQ(buffer.bytes.data(), memory);
  EXPECT_EQ(buffer.bytes, first);
}

/// Triangles around one vertex.
TileMesh fan(std::uint32_t triangles) {
  TileMesh mesh;
  for (std::uint32_t i = 0; i < triangles + 2; ++i) {
    mesh.gridIndices.push_back(static_cast<std::uint16_t>(i));
    for (int axis = 0; axis < 3; ++axis) mesh.normals.push_back(1.0f);
    for (std::uint32_t axis = 0; axis < 3; ++axis) mesh.offsets.push_back(static_cast<std::uint16_t>(i * (axis + 1)));
    if (i >= 2) mesh.triangles.insert(mesh.triangles.end(), {0, i - 1, i});
  }
  return mesh;
}

TEST(DracoTemplate, SaysWhyLibdracoMustDoItAlone) {
  const auto slow = DracoTemplate::learn(sampleMesh(8), {.speed = 1});
  EXPECT_EQ(slow.error().kind, ErrorKind::Unsupported);
  EXPECT_EQ(slow.error().field, "speed");
  const auto crowded = DracoTemplate::learn(fan(kMostFacesAroundEntry + 1), {});
  EXPECT_EQ(crowded.error().kind, ErrorKind::Unsupported);
  EXPECT_EQ(crowded.error().field, "triangles");
}

TEST(DracoTemplate, GivesTheBytesOfLibdracoWithAsManyTrianglesAroundAVertexAsItTakes) {
  const TileMesh model = fan(kMostFacesAroundEntry);
  for (const int speed : {3, 7}) {
    const DracoSettings settings{.speed = speed, .normalBits = 16};
    const auto learnt = DracoTemplate::learn(model, settings);
    ASSERT_TRUE(learnt.has_value()) << learnt.error().text();
    for (const auto& [name, mesh] : test::kindsOfData(model, kSeed))
      EXPECT_TRUE((*learnt)->encode(mesh)->bytes == encodeDraco(mesh, settings)->bytes) << name << ", speed " << speed;
  }
}

TEST(DracoTemplate, LeavesAMeshOfAnotherKindToLibdraco) {
  const auto learnt = DracoTemplate::learn(sampleMesh(8), {});
  ASSERT_TRUE(learnt.has_value());
  TileMesh turned = sampleMesh(8);
  std::rotate(turned.triangles.begin(), turned.triangles.begin() + 3, turned.triangles.end());
  TileMesh renumbered = sampleMesh(8);
  std::swap(renumbered.gridIndices.front(), renumbered.gridIndices.back());
  const TileMesh triangle = sampleTile({.path = kSamplePaths[1], .cellsPerEdge = 8}).mesh;
  for (const TileMesh& other :
       {triangle, sampleMesh(4), sampleMesh(8, false), sampleMesh(8, true, false), turned, renumbered}) {
    EXPECT_FALSE((*learnt)->fits(other));
    EXPECT_TRUE((*learnt)->encode(other)->bytes == encodeDraco(other, {})->bytes);
  }
  EXPECT_TRUE((*learnt)->fits(sampleMesh(8)));
}

TEST(DracoTemplate, RefusesWhatLibdracosEncoderRefuses) {
  TileMesh mesh = sampleMesh(8);
  const auto learnt = DracoTemplate::learn(mesh, {});
  ASSERT_TRUE(learnt.has_value());
  for (const float bad : {0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    TileMesh broken = mesh;
    for (std::size_t c = 0; c < 3; ++c) broken.normals[3 * 7 + c] = bad;
    EXPECT_EQ((*learnt)->encode(broken).error().field, "normals") << bad;
  }
  TileMesh shortened = mesh;
  shortened.offsets.pop_back();
  EXPECT_EQ((*learnt)->encode(shortened).error().field, "offsets");
  TileMesh fewColors = mesh;
  fewColors.colors.pop_back();
  EXPECT_EQ((*learnt)->encode(fewColors).error().field, "colors");

  TileMesh loose = mesh;  // a vertex without triangle
  loose.gridIndices.push_back(0);
  for (int i = 0; i < 3; ++i) {
    loose.offsets.push_back(0);
    loose.normals.push_back(1.0f);
    loose.colors.push_back(0);
  }
  EXPECT_EQ(DracoTemplate::learn(loose, {}).error().kind, ErrorKind::InvalidArgument);
  EXPECT_EQ(DracoTemplate::learn(TileMesh{}, {}).error().kind, ErrorKind::InvalidArgument);
  EXPECT_EQ(DracoTemplate::learn(mesh, {.speed = 7, .normalBits = 0}).error().field, "normalBits");
}

}  // namespace
}  // namespace terrane::test

#include "proto/gltf_tile.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "proto/glb_container.h"
#include "tests/unit/proto/sample_tile.h"

namespace terrane::test {
namespace {

constexpr double kNormalTolerance = 0.026;  // 8-bit octahedral, draco_mesh_test

nlohmann::json jsonOf(const std::vector<std::uint8_t>& glb) { return nlohmann::json::parse(unpackGlb(glb)->json); }
/// As it stands in the file.
std::string textOf(const std::vector<std::uint8_t>& glb) { return std::string(unpackGlb(glb)->json); }

TEST(GltfTile, RoundTripIsExact) {
  for (const FacePath& path : kSamplePaths)
    for (const int cells : {1, 16, 64})
      for (const bool skirts : {false, true})
        for (const bool colors : {false, true}) {
          const Tile tile = sampleTile({.path = path, .cellsPerEdge = cells, .skirts = skirts, .colors = colors});
          const auto glb = encodeTile(tile, {});
          ASSERT_TRUE(glb.has_value()) << glb.error().text();
          const auto back = decodeTile(*glb);
          ASSERT_TRUE(back.has_value()) << back.error().text();
          EXPECT_TRUE(sameMetadata(tile.metadata, back->metadata));
          EXPECT_TRUE(sameMesh(tile.mesh, back->mesh, kNormalTolerance));
        }
}

TEST(GltfTile, MetadataKeepsEveryBit) {
  constexpr unsigned kSeed = 11;
  std::mt19937_64 random(kSeed);
  const auto anyDouble = [&](double scale) {
    return std::ldexp(static_cast<double>(static_cast<std::int64_t>(random())), -63) * scale;
  };
  Tile tile = sampleTile({.cellsPerEdge = 2});
  for (int i = 0; i < 300; ++i) {
    TileMetadata& m = tile.metadata;
    const int level = static_cast<int>(random() % 31);
    m.path = FacePath::wholeFace(Scheme::Cube, static_cast<int>(random() % 6));
    for (int k = 0; k < level; ++k) m.path = m.path.child(static_cast<int>(random() % 4));
    m.stepExponent = static_cast<int>(random() % 40) - 23;
    for (int axis = 0; axis < 3; ++axis) m.origin[axis] = static_cast<std::int64_t>(random()) >> 11;
    m.heights = {-std::abs(anyDouble(1e5)), std::abs(anyDouble(1e-5))};
    m.subtreeHeights = {m.heights.minMeters * 1.1, m.heights.maxMeters * 1.1};
    m.geometricErrorMeters = std::abs(anyDouble(std::exp2(-20)));
    m.sphere = {{anyDouble(1e9), anyDouble(1e-9), -0.0}, std::abs(anyDouble(1e6))};
    m.horizonPoint = {anyDouble(1e8), anyDouble(1e8), anyDouble(1e8)};
    if (i % 3 == 0) m.horizonPoint = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    m.skirtMeters = static_cast<float>(std::abs(anyDouble(100)));
    const auto glb = encodeTile(tile, {});
    ASSERT_TRUE(glb.has_value()) << glb.error().text();
    const auto back = decodeTile(*glb);
    ASSERT_TRUE(back.has_value()) << back.error().text() << ", seed " << kSeed;
    EXPECT_TRUE(sameMetadata(m, back->metadata)) << textOf(*glb);
  }
}

TEST(GltfTile, EqualTilesAreEqualBytes) {
  Tile tile = sampleTile({.cellsPerEdge = 16});
  const auto a = encodeTile(tile, {}), b = encodeTile(sampleTile({.cellsPerEdge = 16}), {});
  ASSERT_TRUE(a.has_value() && b.has_value());
  EXPECT_EQ(*a, *b);
  tile.metadata.sphere.center = {0.0, 0.0, 0.0};
  const auto positive = encodeTile(tile, {});
  tile.metadata.sphere.center = {-0.0, 0.0, -0.0};
  EXPECT_EQ(*positive, *encodeTile(tile, {})) << "a zero's sign is not data";
}

TEST(GltfTile, DocumentIsWhatGltfClientsExpect) {
  const Tile tile = sampleTile({.cellsPerEdge = 16});
  const auto glb = *encodeTile(tile, {});
  const nlohmann::json json = jsonOf(glb);
  EXPECT_EQ(json["asset"]["version"], "2.0");
  EXPECT_EQ(json["extensionsUsed"], nlohmann::json::array({"KHR_draco_mesh_compression"}));
  EXPECT_EQ(json["extensionsRequired"], json["extensionsUsed"]);

  const nlohmann::json& node = json["nodes"][0];
  const double s = std::exp2(tile.metadata.stepExponent);
  const LatticePoint o = tile.metadata.origin;
  const auto meters = [&](std::int64_t steps) { return static_cast<double>(steps) * s; };
  const std::vector<double> matrix{s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, meters(o.x), meters(o.z), -meters(o.y), 1};
  EXPECT_EQ(node["matrix"].get<std::vector<double>>(), matrix);
  EXPECT_EQ(node["extras"]["terrane"]["path"], tile.metadata.path.text());

  const nlohmann::json& primitive = json["meshes"][0]["primitives"][0];
  const nlohmann::json& draco = primitive["extensions"]["KHR_draco_mesh_compression"];
  EXPECT_EQ(primitive["mode"], 4);
  for (const auto& [name, id] : draco["attributes"].items())
    EXPECT_TRUE(primitive["attributes"].contains(name)) << name;

  const auto accessor = [&](const char* name) {
    return json["accessors"][primitive["attributes"][name].get<std::size_t>()];
  };
  const TileMesh mesh = decodeTile(glb)->mesh;
  std::vector<int> low(3, 65536), high(3, -1);
  for (std::size_t i = 0; i < mesh.offsets.size(); ++i) {
    low[i % 3] = std::min<int>(low[i % 3], mesh.offsets[i]);
    high[i % 3] = std::max<int>(high[i % 3], mesh.offsets[i]);
  }
  EXPECT_EQ(accessor("POSITION")["min"], low);
  EXPECT_EQ(accessor("POSITION")["max"], high);
  constexpr int kUnsignedByte = 5121, kUnsignedShort = 5123, kFloat = 5126;
  EXPECT_EQ(accessor("POSITION")["componentType"], kFloat);
  EXPECT_EQ(accessor("NORMAL")["componentType"], kFloat);
  EXPECT_EQ(accessor("_GRID")["componentType"], kUnsignedShort);
  EXPECT_EQ(accessor("COLOR_0")["componentType"], kUnsignedByte);
  EXPECT_EQ(accessor("COLOR_0")["normalized"], true);
  for (const char* name : {"POSITION", "NORMAL", "COLOR_0", "_GRID"})
    EXPECT_EQ(accessor(name)["count"], mesh.vertexCount());
  EXPECT_EQ(json["accessors"][primitive["indices"].get<std::size_t>()]["count"], mesh.triangles.size());
  for (const auto& each : json["accessors"]) EXPECT_FALSE(each.contains("bufferView")) << "the data is Draco's";
  EXPECT_EQ(json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"], nlohmann::json::parse("[0.4,0.4,0.4,1]"));
}

TEST(GltfTile, NumbersAreShortAndWithoutNegativeZero) {
  Tile tile = sampleTile({.cellsPerEdge = 2});
  tile.metadata.origin = {1, 0, -3};
  tile.metadata.stepExponent = -23;
  tile.metadata.geometricErrorMeters = 0.1;
  tile.metadata.sphere = {{-0.0, 0.0, 1e300 * 1e-300}, 4503599627370497.5e-6};
  const std::string text = textOf(*encodeTile(tile, {}));
  for (const char* negativeZero : {"-0,", "-0]", "-0.0", "-0}", "-0e"})
    EXPECT_EQ(text.find(negativeZero), std::string::npos) << text;
  EXPECT_NE(text.find("\"geometricError\":0.1,"), std::string::npos) << text;
  EXPECT_NE(text.find("\"origin\":[1,0,-3]"), std::string::npos) << text;
  EXPECT_NE(text.find("\"step\":1.1920928955078125e-07,"), std::string::npos) << text;
}

TEST(GltfTile, OriginsBeyond32BitsAreExactIntegers) {
  Tile tile = sampleTile({.cellsPerEdge = 2});
  tile.metadata.origin = {4503599627370495, -4503599627370495, 4294967297};
  const auto glb = encodeTile(tile, {});
  ASSERT_TRUE(glb.has_value());
  EXPECT_EQ(jsonOf(*glb)["nodes"][0]["extras"]["terrane"]["origin"].dump(),
            "[4503599627370495,-4503599627370495,4294967297]");
  EXPECT_EQ(decodeTile(*glb)->metadata.origin, tile.metadata.origin);
}

TEST(GltfTile, MetadataThatJsonCannotHoldIsRefused) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Tile tile = sampleTile({.cellsPerEdge = 2});
    tile.metadata.geometricErrorMeters = bad;
    EXPECT_EQ(encodeTile(tile, {}).error().kind, ErrorKind::InvalidArgument);
    tile = sampleTile({.cellsPerEdge = 2});
    tile.metadata.sphere.center.y = bad;
    EXPECT_EQ(encodeTile(tile, {}).error().kind, ErrorKind::InvalidArgument);
  }
}

}  // namespace
}  // namespace terrane::test

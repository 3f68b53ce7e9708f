// decodeTile on bytes that somebody made wrong on purpose, or a disk by chance.

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "proto/glb_container.h"
#include "proto/gltf_tile.h"
#include "tests/unit/proto/sample_tile.h"

namespace terrane::test {
namespace {

const std::vector<std::uint8_t>& sampleGlb() {
  static const std::vector<std::uint8_t> glb = *encodeTile(sampleTile({.cellsPerEdge = 8}), {});
  return glb;
}

const std::vector<std::uint8_t>& triangleGlb() {
  static const std::vector<std::uint8_t> glb =
      *encodeTile(sampleTile({.path = kSamplePaths[1], .cellsPerEdge = 8}), {});
  return glb;
}

nlohmann::json document() { return nlohmann::json::parse(unpackGlb(sampleGlb())->json); }

std::vector<std::uint8_t> withDocument(std::string_view json) { return packGlb(json, unpackGlb(sampleGlb())->bin); }

struct Refusal {
  ErrorKind kind = ErrorKind::Internal;
  std::string field = "accepted";
  bool operator==(const Refusal&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Refusal& r) { return out << errorKindName(r.kind) << ' ' << r.field; }

Refusal refusalOf(std::span<const std::uint8_t> glb) {
  const auto tile = decodeTile(glb);
  return tile ? Refusal{} : Refusal{tile.error().kind, tile.error().field};
}

Refusal refusalWith(const std::string& pointer, const nlohmann::json& value) {
  nlohmann::json json = document();
  json[nlohmann::json::json_pointer(pointer)] = value;
  return refusalOf(withDocument(json.dump()));
}

/// Whatever is accepted must be a tile that a renderer can trust.
void expectSound(const Tile& tile) {
  const TileMesh& mesh = tile.mesh;
  const Scheme scheme = tile.metadata.path.scheme();
  const int cells = tile.metadata.cellsPerEdge;
  const std::size_t gridLimit = gridVertexCount(scheme, cells) + skirtVertexCount(scheme, cells);
  ASSERT_EQ(mesh.offsets.size(), 3 * mesh.vertexCount());
  ASSERT_EQ(mesh.normals.size(), 3 * mesh.vertexCount());
  ASSERT_TRUE(mesh.colors.empty() || mesh.colors.size() == 3 * mesh.vertexCount());
  for (const std::uint32_t index : mesh.triangles) ASSERT_LT(index, mesh.vertexCount());
  for (const std::uint16_t index : mesh.gridIndices) ASSERT_LT(index, gridLimit);
  for (const float component : mesh.normals) ASSERT_LE(std::abs(component), 1.01f);
  ASSERT_TRUE(std::isfinite(tile.metadata.geometricErrorMeters) && std::isfinite(tile.metadata.sphere.radiusMeters));
}

TEST(HostileTile, TheUntouchedTileIsAccepted) {
  EXPECT_TRUE(decodeTile(sampleGlb()).has_value());
  EXPECT_EQ(refusalOf(withDocument(document().dump())), Refusal{}) << "rewritten by a JSON library";
}

TEST(HostileTile, CutAnywhereItIsAnError) {
  const auto& glb = sampleGlb();
  for (std::size_t length = 0; length < glb.size(); ++length) {
    EXPECT_FALSE(decodeTile(std::span(glb).first(length)).has_value()) << length << " of " << glb.size();
  }
}

TEST(HostileTile, CutWithAnHonestLengthItIsAnErrorToo) {
  const auto chunks = *unpackGlb(sampleGlb());
  for (std::size_t length = 0; length < chunks.bin.size(); ++length) {
    EXPECT_FALSE(decodeTile(packGlb(chunks.json, chunks.bin.first(length))).has_value()) << length;
  }
}

TEST(HostileTile, EveryWordOfTheContainerMayLie) {
  const std::size_t jsonBytes = unpackGlb(sampleGlb())->json.size();
  const std::array words{std::size_t{0},  std::size_t{4}, std::size_t{8}, std::size_t{12},
                         std::size_t{16}, 20 + jsonBytes, 24 + jsonBytes};
  for (const std::size_t at : words) {
    for (const std::uint32_t lie : {0u, 1u, 2u, 3u, 4u, 0x7FFFFFFCu, 0x80000000u, 0xFFFFFFFCu, 0xFFFFFFFFu}) {
      std::vector<std::uint8_t> glb = sampleGlb();
      for (std::size_t i = 0; i < 4; ++i) glb[at + i] = static_cast<std::uint8_t>(lie >> (8 * i));
      if (glb == sampleGlb()) continue;
      EXPECT_FALSE(decodeTile(glb).has_value()) << "word at " << at << " says " << lie;
    }
  }
}

TEST(HostileTile, FlippedBitsGiveAnErrorOrASoundTile) {
  for (unsigned seed = 0; seed < 10000; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> glb = seed % 2 == 0 ? sampleGlb() : triangleGlb();
    for (auto flips = 1 + random() % 3; flips > 0; --flips)
      glb[random() % glb.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    const auto tile = decodeTile(glb);
    if (!tile) continue;
    ASSERT_NO_FATAL_FAILURE(expectSound(*tile)) << "seed " << seed;
  }
}

TEST(HostileTile, RefusalsNameTheMember) {
  const std::string extras = "/nodes/0/extras/terrane";
  using nlohmann::json;
  const std::vector<std::tuple<std::string, json, std::string>> cases{
      {extras, json::object(), "extras.terrane.path"},
      {extras, 1, "extras.terrane"},
      {extras + "/path", "cube/6", "extras.terrane.path"},
      {extras + "/path", "../../etc/passwd", "extras.terrane.path"},
      {extras + "/path", std::string(5000, '0'), "extras.terrane.path"},
      {extras + "/path", nullptr, "extras.terrane.path"},
      {extras + "/level", 8, "extras.terrane.level"},
      {extras + "/level", 7.5, "extras.terrane.level"},
      {extras + "/stepExponent", 1, "extras.terrane.step"},
      {extras + "/stepExponent", 2000000000, "extras.terrane.stepExponent"},
      {extras + "/step", 0.3, "extras.terrane.step"},
      {extras + "/origin", json::array({0, 0}), "extras.terrane.origin"},
      {extras + "/origin/0", 0.5, "extras.terrane.origin[0]"},
      {extras + "/origin/1", 1e30, "extras.terrane.origin[1]"},
      {extras + "/origin/2", 18446744073709551615ull, "extras.terrane.origin[2]"},
      {extras + "/origin/2", std::numeric_limits<std::int64_t>::min(), "extras.terrane.origin[2]"},
      {extras + "/origin/2", 7, "json.nodes[0].matrix[13]"},
      {extras + "/heights", json::array({5, -5}), "extras.terrane.heights"},
      {extras + "/heights/0", nullptr, "extras.terrane.heights[0]"},
      {extras + "/subtreeHeights", json::array({0, 0}), "extras.terrane.subtreeHeights"},
      {extras + "/geometricError", -1, "extras.terrane.geometricError"},
      {extras + "/sphere", json::array({0, 0, 0}), "extras.terrane.sphere"},
      {extras + "/sphere/3", -1, "extras.terrane.sphere[3]"},
      {extras + "/horizonPoint", 3, "extras.terrane.horizonPoint"},
      {extras + "/horizonPoint/0", "far", "extras.terrane.horizonPoint[0]"},
      {extras + "/cellsPerEdge", 0, "extras.terrane.cellsPerEdge"},
      {extras + "/cellsPerEdge", 4, "draco"},
      {extras + "/cellsPerEdge", 1000, "extras.terrane.cellsPerEdge"},
      {extras + "/skirt", -1, "extras.terrane.skirt"},
      {"/asset/version", "3.0", "json.asset.version"},
      {"/scene", 1, "json.scenes[1]"},
      {"/scene", -1, "json.scene"},
      {"/scenes/0/nodes", json::array({0, 0}), "json.scenes[0].nodes"},
      {"/scenes/0/nodes/0", 4294967296, "json.scenes[0].nodes[0]"},
      {"/nodes/0/matrix/0", 2, "json.nodes[0].matrix[0]"},
      {"/nodes/0/matrix/15", 0, "json.nodes[0].matrix[15]"},
      {"/nodes/0/matrix", json::array(), "json.nodes[0].matrix"},
      {"/nodes/0/mesh", 3, "json.meshes[3]"},
      {"/meshes/0/primitives/0/mode", 0, "json.meshes[0].primitives[0].mode"},
      {"/meshes/0/primitives/0/indices", 99, "json.accessors[99]"},
      {"/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/bufferView", 7, "json.bufferViews[7]"},
      {"/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/POSITION", 32,
       "json.meshes[0].primitives[0].extensions.KHR_draco_mesh_compression.attributes.POSITION"},
      {"/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/POSITION", 1, "draco"},
      {"/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/_GRID", -1,
       "json.meshes[0].primitives[0].extensions.KHR_draco_mesh_compression.attributes._GRID"},
      {"/buffers/0/byteLength", 4294967295u, "json.buffers[0].byteLength"},
      {"/bufferViews/0/byteLength", 4294967295u, "json.bufferViews[0].byteLength"},
      {"/bufferViews/0/byteOffset", 1, "json.bufferViews[0].byteLength"},
      {"/bufferViews/0/byteOffset", -1, "json.bufferViews[0].byteOffset"},
      {"/bufferViews/0/buffer", 1, "json.bufferViews[0].buffer"},
      {"/bufferViews/0/byteLength", 0, "draco"},
      {"/accessors/0/count", 3, "draco"},
      {"/accessors/1/count", 1, "draco"},
      {"/accessors/1/count", 0, "json.accessors[1].count"},
  };
  for (const auto& [pointer, value, field] : cases) {
    EXPECT_EQ(refusalWith(pointer, value).field, field) << pointer << " = " << value;
  }
}

TEST(HostileTile, ATriangularTileIsHeldToItsOwnGrid) {
  const auto refusalOfTriangle = [](const char* key, const nlohmann::json& value) {
    nlohmann::json json = nlohmann::json::parse(unpackGlb(triangleGlb())->json);
    json["nodes"][0]["extras"]["terrane"][key] = value;
    return refusalOf(packGlb(json.dump(), unpackGlb(triangleGlb())->bin)).field;
  };
  EXPECT_EQ(refusalOf(triangleGlb()).field, "accepted");
  EXPECT_EQ(refusalOfTriangle("cellsPerEdge", 7), "draco") << "grid indices beyond the grid";
  EXPECT_EQ(refusalOfTriangle("cellsPerEdge", 357), "accepted");
  EXPECT_EQ(refusalOfTriangle("cellsPerEdge", 358), "extras.terrane.cellsPerEdge") << "65,697 vertices";
  EXPECT_EQ(refusalOfTriangle("path", "ico/20/0321330"), "extras.terrane.path");
  EXPECT_EQ(refusalOfTriangle("path", "ico/17/0321334"), "extras.terrane.path");
  // A square of eight cells has 117 vertices with its skirts, the triangle 72.
  EXPECT_EQ(refusalWith("/nodes/0/extras/terrane/path", "ico/2/0321330").field, "draco");
}

TEST(HostileTile, EveryMemberOfTheMetadataIsNeeded) {
  const nlohmann::json metadata = document()["nodes"][0]["extras"]["terrane"];
  for (const auto& [key, value] : metadata.items()) {
    if (key == "horizonPoint") continue;  // absent as if null
    nlohmann::json json = document();
    json["nodes"][0]["extras"]["terrane"].erase(key);
    EXPECT_EQ(refusalOf(withDocument(json.dump())).field, "extras.terrane." + key);
  }
}

TEST(HostileTile, NoFileIsOpened) {
  // A pipe that nobody writes to: whoever opens it for reading waits for ever.
  const std::string pipe =
      (std::filesystem::temp_directory_path() / ("terrane_pipe_" + std::to_string(::getpid()))).string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& uri :
       {pipe, "file://" + pipe, std::string("/etc/passwd"), std::string("../../../../etc/passwd")}) {
    EXPECT_EQ(refusalWith("/buffers/0/uri", uri), (Refusal{ErrorKind::Unsupported, "json.buffers[0].uri"}));
    nlohmann::json json = document();
    json["images"] = {{{"uri", uri}}};
    EXPECT_EQ(refusalOf(withDocument(json.dump())), Refusal{}) << "images are nobody's business";
  }
  std::filesystem::remove(pipe);
}

TEST(HostileTile, BombsAreRefusedBeforeTheyAreParsed) {
  EXPECT_EQ(refusalOf(withDocument(std::string(60000, '['))), (Refusal{ErrorKind::TooLarge, "json"}));
  EXPECT_EQ(refusalOf(withDocument(std::string(100000, ' '))), (Refusal{ErrorKind::TooLarge, "json"}));
  EXPECT_EQ(refusalOf(std::vector<std::uint8_t>(16u << 20)), (Refusal{ErrorKind::TooLarge, "header"}));
  for (const std::string text :
       {"", "{", "[1,2", "{\"a\":1e999}", "{\"a\":\"\xc0\x80\"}", "nul", "{\"a\":NaN}", "{}garbage"}) {
    EXPECT_EQ(refusalOf(withDocument(text)), (Refusal{ErrorKind::Malformed, "json"})) << text;
  }
}

TEST(HostileTile, AnyMemberMayBeOfAnyType) {
  const nlohmann::json flat = document().flatten();
  const std::array values{nlohmann::json(nullptr),  nlohmann::json(true),
                          nlohmann::json(-1),       nlohmann::json(1e308),
                          nlohmann::json(""),       nlohmann::json::array(),
                          nlohmann::json::object(), nlohmann::json(18446744073709551615ull)};
  for (const auto& [pointer, old] : flat.items()) {
    for (const auto& value : values) {
      nlohmann::json json = document();
      json[nlohmann::json::json_pointer(pointer)] = value;
      const auto tile = decodeTile(withDocument(json.dump()));
      if (!tile) continue;
      ASSERT_NO_FATAL_FAILURE(expectSound(*tile)) << pointer << " = " << value;
    }
  }
}

}  // namespace
}  // namespace terrane::test

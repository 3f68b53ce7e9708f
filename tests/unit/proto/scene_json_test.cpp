#include "proto/scene_json.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "common/scene/scene.h"
#include "common/tiling/lattice.h"

namespace terrane::test {
namespace {

BodyInfo moon() {
  BodyInfo body;
  body.name = "moon";
  body.revision = "0123456789abcdef";
  body.schemes = {Scheme::Cube};
  body.positionScene = {384400000.125, -1e-3, kMaxPositionMeters};
  body.selection.radiusMeters = 1737400;
  body.selection.maxLevel = 3;
  body.selection.heights = {-9123.456789012345, 10786.100000000001};
  body.selection.occluderRadiusMeters = 1728276.5432109876;
  body.selection.geometricErrorMeters = {1000.1, 500.05, 250.025, 0x1.fffffffffffffp-3};
  return body;
}

SceneInfo scene() {
  SceneInfo scene{"moon", "The Moon, \"as it is\"\n\u2014 roughly", {moon()}, {}};
  EffectCall sun{EffectKind::Sun, defaultValues(effectRow(EffectKind::Sun).parameters)};
  sun.parameters["longitude"] = 0.1;
  scene.effects.push_back(sun);
  return scene;
}

nlohmann::json document() { return nlohmann::json::parse(writeSceneJson(scene())); }

std::string refusedKey(const nlohmann::json& changed) {
  const auto read = readSceneJson(changed.dump());
  return read ? "accepted" : read.error().field;
}

TEST(SceneJson, ABodyOnTheIcosahedronIsSelectedFromItsTiles) {
  SceneInfo wrote = scene();
  wrote.bodies[0].schemes = {Scheme::Ico};
  const auto read = readSceneJson(writeSceneJson(wrote));
  ASSERT_TRUE(read.has_value()) << read.error().text();
  EXPECT_EQ(read->bodies[0].schemes, std::vector{Scheme::Ico});
  EXPECT_EQ(read->bodies[0].selection.scheme, Scheme::Ico);
}

TEST(SceneJson, ReadsBackWhatItWrote) {
  const SceneInfo wrote = scene();
  const auto read = readSceneJson(writeSceneJson(wrote));
  ASSERT_TRUE(read.has_value()) << read.error().text();
  EXPECT_EQ(read->name, wrote.name);
  EXPECT_EQ(read->summary, wrote.summary);
  ASSERT_EQ(read->bodies.size(), 1u);
  const BodyInfo &a = wrote.bodies[0], &b = read->bodies[0];
  EXPECT_EQ(b.name, a.name);
  EXPECT_EQ(b.revision, a.revision);
  EXPECT_EQ(b.schemes, a.schemes);
  EXPECT_EQ(b.cellsPerEdge, a.cellsPerEdge);
  EXPECT_EQ(b.positionScene, a.positionScene);
  EXPECT_EQ(b.selection.scheme, Scheme::Cube);
  EXPECT_EQ(b.selection.radiusMeters, a.selection.radiusMeters);
  EXPECT_EQ(b.selection.maxLevel, a.selection.maxLevel);
  EXPECT_EQ(b.selection.heights.minMeters, a.selection.heights.minMeters);
  EXPECT_EQ(b.selection.heights.maxMeters, a.selection.heights.maxMeters);
  EXPECT_EQ(b.selection.occluderRadiusMeters, a.selection.occluderRadiusMeters);
  EXPECT_EQ(b.selection.geometricErrorMeters, a.selection.geometricErrorMeters);
  ASSERT_EQ(read->effects.size(), 1u);
  EXPECT_EQ(read->effects[0].kind, EffectKind::Sun);
  EXPECT_EQ(read->effects[0].parameters, wrote.effects[0].parameters);
}

TEST(SceneJson, KeepsEveryBitOfADouble) {
  constexpr unsigned kSeed = 7;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> exponent(std::log2(kMinRadiusMeters), std::log2(kMaxRadiusMeters) - 0.01);
  for (int i = 0; i < 500; ++i) {
    SceneInfo wrote = scene();
    SelectionBody& body = wrote.bodies[0].selection;
    body.radiusMeters = std::exp2(exponent(random));
    body.heights = {-body.radiusMeters / 3, body.radiusMeters / 7};
    body.geometricErrorMeters = {body.radiusMeters / 11, body.radiusMeters / 23, 1e-3 / 3,
                                 std::bit_cast<double>(random() >> 12)};
    const auto read = readSceneJson(writeSceneJson(wrote));
    ASSERT_TRUE(read.has_value()) << "seed " << kSeed << ": " << read.error().text();
    EXPECT_EQ(read->bodies[0].selection.radiusMeters, body.radiusMeters);
    EXPECT_EQ(read->bodies[0].selection.heights.minMeters, body.heights.minMeters);
    EXPECT_EQ(read->bodies[0].selection.geometricErrorMeters, body.geometricErrorMeters);
  }
}

TEST(SceneJson, ADocumentOlderThanPositionsHasItsBodiesAtTheOrigin) {
  nlohmann::json json = document();
  json["bodies"][0].erase("positionMeters");
  const auto read = readSceneJson(json.dump());
  ASSERT_TRUE(read.has_value()) << read.error().text();
  EXPECT_EQ(read->bodies[0].positionScene, glm::dvec3(0.0));
}

TEST(SceneJson, AnOldViewerOpensANewerServersScene) {
  nlohmann::json json = document();
  for (const char* name : {"aurora", "sn\now", "aurora"})
    json["effects"].push_back({{"name", name}, {"parameters", {{"brightness", 2}}}});
  json["effects"][0]["parameters"]["colour"] = "red";
  json["effects"][0]["parameters"].erase("latitude");
  json["limits"] = {{"tiles", 5}};
  json["bodies"][0]["atmosphere"] = nullptr;
  const auto read = readSceneJson(json.dump());
  ASSERT_TRUE(read.has_value()) << read.error().text();
  EXPECT_EQ(read->unknownEffects, (std::vector<std::string>{"aurora", "sn\now"}));
  ASSERT_EQ(read->effects.size(), 1u);
  EXPECT_EQ(read->effects[0].parameters.count("colour"), 0u);
  EXPECT_EQ(read->effects[0].parameters.count("latitude"), 1u) << "absent settings have their defaults";
}

TEST(SceneJson, RefusalsNameTheKey) {
  using nlohmann::json;
  const std::vector<std::tuple<std::string, json, std::string>> cases{
      {"/name", 5, "name"},
      {"/name", std::string(300, 'a'), "name"},
      {"/bodies", json::array(), "bodies"},
      {"/bodies", json::object(), "bodies"},
      {"/bodies/0", 1, "bodies[0]"},
      {"/bodies/0/name", "Moon", "bodies[0].name"},
      {"/bodies/0/name", "", "bodies[0].name"},
      {"/bodies/0/name", "../etc", "bodies[0].name"},
      {"/bodies/0/revision", "0123", "bodies[0].revision"},
      {"/bodies/0/revision", "0123456789/../..", "bodies[0].revision"},
      {"/bodies/0/schemes", json::array(), "bodies[0].schemes"},
      {"/bodies/0/schemes/0", "square", "bodies[0].schemes[0]"},
      {"/bodies/0/schemes", json::array({"cube", "cube"}), "bodies[0].schemes[1]"},
      {"/bodies/0/radiusMeters", 249.0, "bodies[0].radiusMeters"},
      {"/bodies/0/radiusMeters", 7.1e8, "bodies[0].radiusMeters"},
      {"/bodies/0/radiusMeters", -1737400, "bodies[0].radiusMeters"},
      {"/bodies/0/radiusMeters", nullptr, "bodies[0].radiusMeters"},
      {"/bodies/0/radiusMeters", "1737400", "bodies[0].radiusMeters"},
      {"/bodies/0/positionMeters", 5, "bodies[0].positionMeters"},
      {"/bodies/0/positionMeters", json::array({0, 0}), "bodies[0].positionMeters"},
      {"/bodies/0/positionMeters/1", "0 km", "bodies[0].positionMeters[1]"},
      {"/bodies/0/positionMeters/2", 1.1e13, "bodies[0].positionMeters[2]"},
      {"/bodies/0/maxLevel", 31, "bodies[0].maxLevel"},
      {"/bodies/0/maxLevel", -1, "bodies[0].maxLevel"},
      {"/bodies/0/maxLevel", 2.5, "bodies[0].maxLevel"},
      {"/bodies/0/maxLevel", 18446744073709551615ull, "bodies[0].maxLevel"},
      {"/bodies/0/maxLevel", 2, "bodies[0].geometricErrorMeters"},
      {"/bodies/0/cellsPerEdge", 0, "bodies[0].cellsPerEdge"},
      {"/bodies/0/heightsMeters", json::array({1, 0}), "bodies[0].heightsMeters"},
      {"/bodies/0/heightsMeters/0", -1e9, "bodies[0].heightsMeters[0]"},
      {"/bodies/0/geometricErrorMeters/1", 2000, "bodies[0].geometricErrorMeters[1]"},
      {"/bodies/0/geometricErrorMeters/1", 1000.1, "bodies[0].geometricErrorMeters[1]"},
      {"/bodies/0/geometricErrorMeters/3", -1, "bodies[0].geometricErrorMeters[3]"},
      {"/bodies/0/geometricErrorMeters/2", nullptr, "bodies[0].geometricErrorMeters[2]"},
      {"/effects", 1, "effects"},
      {"/effects/0/name", nullptr, "effects[0].name"},
      {"/effects/0/parameters/longitude", 1e9, "effects[0].parameters.longitude"},
  };
  for (const auto& [pointer, value, key] : cases) {
    json changed = document();
    changed[json::json_pointer(pointer)] = value;
    EXPECT_EQ(refusedKey(changed), key) << pointer << " = " << value;
  }
  json twice = document();
  twice["bodies"].push_back(twice["bodies"][0]);
  EXPECT_EQ(refusedKey(twice), "bodies[1].name");
  const json body = document()["bodies"][0];
  for (const auto& [key, value] : body.items()) {
    if (key == "positionMeters") continue;  // older documents have none
    json missing = document();
    missing["bodies"][0].erase(key);
    EXPECT_EQ(refusedKey(missing), "bodies[0]." + key);
  }
}

TEST(SceneJson, BombsAreRefusedBeforeTheyAreParsed) {
  const auto kindOf = [](const std::string& text) {
    const auto read = readSceneJson(text);
    return read ? ErrorKind::Internal : read.error().kind;
  };
  EXPECT_EQ(kindOf(std::string(900000, '[')), ErrorKind::TooLarge);
  EXPECT_EQ(kindOf(std::string(2u << 20, ' ')), ErrorKind::TooLarge);
  std::string nested;
  for (int i = 0; i < 20000; ++i) nested += "{\"a\":";
  EXPECT_EQ(kindOf(nested), ErrorKind::TooLarge);
  for (const std::string text :
       {"", "null", "1", "\"", "{", "[]", "{\"name\":1e999}", "{\"name\":\"\xff\"}", "nan", "{\"a\":}"}) {
    EXPECT_EQ(kindOf(text), ErrorKind::Malformed) << text;
  }
}

TEST(SceneJson, CutAnywhereItIsAnError) {
  const std::string text = writeSceneJson(scene());
  for (std::size_t length = 0; length < text.size(); ++length) {
    EXPECT_FALSE(readSceneJson(std::string_view(text).substr(0, length)).has_value()) << length;
  }
}

}  // namespace
}  // namespace terrane::test

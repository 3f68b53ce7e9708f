#include "proto/scene_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/scene/scene.h"
#include "common/tiling/lattice.h"
#include "proto/json_cursor.h"

namespace terrane {
namespace {

constexpr JsonDocument::Limits kLimits{.maxBytes = 1u << 20, .maxDepth = 16};
constexpr std::size_t kMaxBodies = 256, kMaxEffects = 256, kMaxSchemes = 2;
constexpr std::size_t kMaxNameBytes = 256, kMaxSummaryBytes = 4096;
constexpr int kMaxCellsPerEdge = 1024;

bool consistsOf(std::string_view text, std::size_t shortest, std::size_t longest, std::string_view characters) {
  return text.size() >= shortest && text.size() <= longest &&
         text.find_first_not_of(characters) == std::string_view::npos;
}

std::string readPattern(const JsonCursor& at, std::size_t shortest, std::size_t longest, std::string_view characters,
                        const char* expected) {
  std::string text = at.text(longest);
  if (at.ok() && !consistsOf(text, shortest, longest, characters)) at.fail(expected);
  return text;
}

std::vector<Scheme> readSchemes(const JsonCursor& at) {
  std::vector<Scheme> schemes;
  const std::size_t count = at.arraySize(1, kMaxSchemes);
  for (std::size_t i = 0; i < count && at.ok(); ++i) {
    const std::string name = at.element(i).text(kMaxNameBytes);
    const auto known = name == schemeName(Scheme::Cube)  ? std::optional(Scheme::Cube)
                       : name == schemeName(Scheme::Ico) ? std::optional(Scheme::Ico)
                                                         : std::nullopt;
    if (!known) {
      at.element(i).fail("not a scheme");
    } else if (std::find(schemes.begin(), schemes.end(), *known) != schemes.end()) {
      at.element(i).fail("named twice");
    } else {
      schemes.push_back(*known);
    }
  }
  return schemes;
}

/// One error a level, each below the one before.
std::vector<double> readGeometricErrors(const JsonCursor& at, int maxLevel) {
  std::vector<double> errors;
  const auto count = static_cast<std::size_t>(maxLevel) + 1;
  at.arraySize(count, count);
  for (std::size_t i = 0; i < count && at.ok(); ++i) {
    const double error = at.element(i).number(0, kMaxRadiusMeters);
    if (i > 0 && error >= errors.back()) at.element(i).fail("not below the level before");
    errors.push_back(error);
  }
  return errors;
}

BodyInfo readBody(const JsonCursor& at) {
  BodyInfo body;
  body.name =
      readPattern(at.member("name"), 1, 32, "abcdefghijklmnopqrstuvwxyz0123456789-", "not 1 to 32 of a-z, 0-9 and -");
  body.revision = readPattern(at.member("revision"), 8, 64, "0123456789abcdef", "not 8 to 64 of 0-9 and a-f");
  body.schemes = readSchemes(at.member("schemes"));
  body.cellsPerEdge = static_cast<int>(at.member("cellsPerEdge").integer(1, kMaxCellsPerEdge));

  if (const auto position = at.optionalMember("positionMeters")) {
    position->arraySize(3, 3);
    for (int axis = 0; axis < 3; ++axis)
      body.positionScene[axis] =
          position->element(static_cast<std::size_t>(axis)).number(-kMaxPositionMeters, kMaxPositionMeters);
  }

  SelectionBody& selection = body.selection;
  if (!body.schemes.empty()) selection.scheme = body.schemes.front();
  selection.radiusMeters = at.member("radiusMeters").number(kMinRadiusMeters, kMaxRadiusMeters);
  selection.maxLevel = static_cast<int>(at.member("maxLevel").integer(0, FacePath::kMaxLevel));
  const JsonCursor heights = at.member("heightsMeters");
  heights.arraySize(2, 2);
  selection.heights.minMeters = heights.element(0).number(-selection.radiusMeters, selection.radiusMeters);
  selection.heights.maxMeters = heights.element(1).number(-selection.radiusMeters, selection.radiusMeters);
  if (selection.heights.minMeters > selection.heights.maxMeters) heights.fail("the lowest is above the highest");
  selection.occluderRadiusMeters = at.member("occluderRadiusMeters").number(0, 2 * kMaxRadiusMeters);
  selection.geometricErrorMeters = readGeometricErrors(at.member("geometricErrorMeters"), selection.maxLevel);
  return body;
}

/// Settings that this build does not know are skipped, absent ones have their defaults.
void readEffect(const JsonCursor& at, SceneInfo& scene) {
  const std::string name = at.member("name").text(kMaxNameBytes);
  const auto kind = findEffect(name);
  if (!kind) {
    if (std::ranges::count(scene.unknownEffects, name) == 0) scene.unknownEffects.push_back(name);
    return;
  }
  EffectCall call{*kind, defaultValues(effectRow(*kind).parameters)};
  const auto parameters = at.optionalMember("parameters");
  for (const ParameterSpec& spec : effectRow(*kind).parameters) {
    const auto value = parameters ? parameters->optionalMember(spec.name) : std::nullopt;
    if (value) call.parameters[std::string(spec.name)] = value->number(spec.minimum, spec.maximum);
  }
  scene.effects.push_back(std::move(call));
}

SceneInfo readScene(const JsonCursor& at) {
  SceneInfo scene;
  scene.name = at.member("name").text(kMaxNameBytes);
  scene.summary = at.member("summary").text(kMaxSummaryBytes);
  const JsonCursor bodies = at.member("bodies");
  const std::size_t bodyCount = bodies.arraySize(1, kMaxBodies);
  for (std::size_t i = 0; i < bodyCount && at.ok(); ++i) {
    scene.bodies.push_back(readBody(bodies.element(i)));
    const auto same = [&](const BodyInfo& other) { return other.name == scene.bodies.back().name; };
    if (std::count_if(scene.bodies.begin(), scene.bodies.end(), same) > 1)
      bodies.element(i).member("name").fail("named twice");
  }
  const JsonCursor effects = at.member("effects");
  const std::size_t effectCount = effects.arraySize(0, kMaxEffects);
  for (std::size_t i = 0; i < effectCount && at.ok(); ++i) {
    readEffect(effects.element(i), scene);
  }
  return scene;
}

nlohmann::ordered_json writeBody(const BodyInfo& body) {
  nlohmann::ordered_json schemes = nlohmann::ordered_json::array();
  for (const Scheme scheme : body.schemes) schemes.push_back(schemeName(scheme));
  const SelectionBody& selection = body.selection;
  const glm::dvec3& position = body.positionScene;
  return {{"name", body.name},
          {"positionMeters", nlohmann::ordered_json::array({position.x, position.y, position.z})},
          {"radiusMeters", selection.radiusMeters},
          {"schemes", std::move(schemes)},
          {"maxLevel", selection.maxLevel},
          {"revision", body.revision},
          {"cellsPerEdge", body.cellsPerEdge},
          {"heightsMeters", nlohmann::ordered_json::array({selection.heights.minMeters, selection.heights.maxMeters})},
          {"occluderRadiusMeters", selection.occluderRadiusMeters},
          {"geometricErrorMeters", selection.geometricErrorMeters}};
}

}  // namespace

std::string writeSceneJson(const SceneInfo& scene) {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::array();
  for (const BodyInfo& body : scene.bodies) bodies.push_back(writeBody(body));
  nlohmann::ordered_json effects = nlohmann::ordered_json::array();
  for (const EffectCall& call : scene.effects) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
    for (const auto& [name, value] : call.parameters) parameters[name] = value;
    effects.push_back({{"name", effectRow(call.kind).name}, {"parameters", std::move(parameters)}});
  }
  const nlohmann::ordered_json document{
      {"name", scene.name}, {"summary", scene.summary}, {"bodies", std::move(bodies)}, {"effects", std::move(effects)}};
  // Names come from a scene file; what is not UTF-8 in them is replaced, so that the document always is.
  return document.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Result<SceneInfo> readSceneJson(std::string_view json) {
  try {
    auto document = JsonDocument::parse(json, kLimits, "scene");
    if (!document) return document.error();
    SceneInfo scene = readScene(document->root(""));
    if (document->error()) return *document->error();
    return scene;
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Malformed, "scene", e.what());
  }
}

}  // namespace terrane

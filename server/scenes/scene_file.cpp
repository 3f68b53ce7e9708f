#include "server/scenes/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/tiling/lattice.h"
#include "server/fields/height_field.h"
#include "server/scenes/body_places.h"
#include "server/scenes/quantity_text.h"
#include "server/scenes/scene_text.h"

// The parser states as preconditions what broken files break ("[." does): an abort as assertions, undefined as the
// assumptions that NDEBUG makes of them. As neither, the code behind them reports an error like any other.
#undef NDEBUG
#define TOML_ASSERT(expression) static_cast<void>(0)
// It recurses with the depth of nesting; scenes need three levels.
#define TOML_EXCEPTIONS 0
#define TOML_MAX_NESTED_VALUES 16
#define TOML_ENABLE_FORMATTERS 0
#define TOML_ENABLE_UNRELEASED_FEATURES 0
#include <toml++/toml.h>

namespace terrane {
namespace {

constexpr std::size_t kMaxSummaryBytes = 200;
constexpr std::string_view kNamePattern = "1 to 32 of a-z, 0-9 and -";

bool isName(std::string_view text) {
  return !text.empty() && text.size() <= 32 &&
         std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

std::string listOf(std::span<const std::string_view> words) { return fmt::format("{}", fmt::join(words, ", ")); }

template <class Row>
std::vector<std::string_view> namesOf(std::span<const Row> table) {
  std::vector<std::string_view> names;
  for (const Row& row : table) names.push_back(row.name);
  return names;
}

std::string_view typeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a floating-point number";
    case toml::node_type::boolean:
      return "a boolean";
    case toml::node_type::date:
      return "a date";
    case toml::node_type::time:
      return "a time";
    case toml::node_type::date_time:
      return "a date and time";
    case toml::node_type::none:
      break;
  }
  return "nothing";
}

/// Turns a parsed table into a scene. The first thing found wrong is kept and reading goes on without effect, so that
/// the code reads as the format does.
class SceneReader {
 public:
  explicit SceneReader(std::string_view fileName) : fileName_(fileName) {}

  Result<Scene> read(const toml::table& root) {
    Scene scene;
    static constexpr std::array<std::string_view, 4> kKeys{"name", "summary", "body", "effects"};
    checkKeys(root, "", kKeys);
    scene.name = readName(root, "", "name");
    readSummary(root, scene.summary);
    readBodies(root, scene.bodies);
    readEffects(root, scene.effects);
    if (error_) return *std::move(error_);
    return scene;
  }

 private:
  void fail(const toml::source_region& where, std::string key, std::string_view what,
            ErrorKind kind = ErrorKind::InvalidArgument) {
    if (error_) return;
    const auto line = std::max<toml::source_index>(where.begin.line, 1);
    std::string message = fmt::format("{}:{}: {}: {}", fileName_, line, key, what);
    error_ = makeError(kind, std::move(key), std::move(message));
  }

  static std::string join(std::string_view path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
  }

  void wrongType(const toml::node& node, std::string key, std::string_view expected) {
    fail(node.source(), std::move(key), fmt::format("is {}; expected {}", typeName(node), expected));
  }

  static std::string bareKey(std::string_view key) {
    const bool bare = !key.empty() && key.size() <= 60 && std::ranges::all_of(key, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    });
    return bare ? std::string(key) : quotedForMessage(key);
  }

  void unknown(const toml::source_region& where, std::string key, std::string_view word, std::string_view kind,
               std::span<const std::string_view> allowed) {
    const std::string_view near = nearestWord(word, allowed);
    fail(where, std::move(key),
         fmt::format("unknown {}{}; allowed: {}", kind, near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                     allowed.empty() ? "none" : listOf(allowed)));
  }

  /// Of several unknown keys, names the one that stands first in the file.
  void checkKeys(const toml::table& table, const std::string& path, std::span<const std::string_view> allowed) {
    const toml::key* first = nullptr;
    for (auto&& [key, value] : table) {
      if (std::ranges::count(allowed, key.str()) > 0) continue;
      if (!first || key.source().begin < first->source().begin) first = &key;
    }
    if (first) unknown(first->source(), join(path, bareKey(first->str())), first->str(), "key", allowed);
  }

  const toml::node* required(const toml::table& table, const std::string& path, std::string_view key,
                             std::string_view expected) {
    const toml::node* node = table.get(key);
    if (!node) fail(table.source(), join(path, key), fmt::format("is missing; expected {}", expected));
    return node;
  }

  std::string readName(const toml::table& table, const std::string& path, std::string_view key) {
    const toml::node* node = required(table, path, key, fmt::format("a name: {}", kNamePattern));
    if (!node) return {};
    const std::optional<std::string> text = node->value_exact<std::string>();
    if (!text)
      wrongType(*node, join(path, key), "a string");
    else if (!isName(*text))
      fail(node->source(), join(path, key),
           fmt::format("{} is not a name; allowed: {}", quotedForMessage(*text), kNamePattern));
    return text.value_or("");
  }

  void readSummary(const toml::table& root, std::string& summary) {
    const toml::node* node = root.get("summary");
    if (!node) return;
    const std::optional<std::string> text = node->value_exact<std::string>();
    if (!text) return wrongType(*node, "summary", "a string");
    const bool control =
        std::ranges::any_of(*text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
    if (text->size() > kMaxSummaryBytes || control)
      return fail(node->source(), "summary", fmt::format("allowed: one line of at most {} bytes", kMaxSummaryBytes));
    summary = *text;
  }

  void readBodies(const toml::table& root, std::vector<Body>& bodies) {
    const toml::node* node = required(root, "", "body", "at least one [[body]]");
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array || !array->is_homogeneous(toml::node_type::table))
      return array && array->empty() ? fail(node->source(), "body", "is empty; expected at least one [[body]]")
                                     : wrongType(*node, "body", "an array of tables, written [[body]]");
    if (array->size() > kMaxSceneBodies)
      return fail(node->source(), "body", fmt::format("{} bodies; allowed: 1 to {}", array->size(), kMaxSceneBodies),
                  ErrorKind::TooLarge);
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::table& table = *array->get(i)->as_table();
      bodies.push_back(readBody(table, fmt::format("body[{}]", i)));
      for (std::size_t k = 0; k < i; ++k)
        if (bodies[k].name == bodies[i].name)
          fail(table.get("name") ? table.get("name")->source() : table.source(), fmt::format("body[{}].name", i),
               fmt::format("\"{}\" is the name of body[{}] already; allowed: names that differ", bodies[i].name, k));
    }
    if (!error_) checkPlaces(*array, bodies);
  }

  Body readBody(const toml::table& table, const std::string& path) {
    Body body;
    const std::vector<std::string_view> fields = namesOf(fieldTable());
    std::vector<std::string_view> keys{"name", "radius", "position", "schemes", "seed", "field"};
    for (const FieldRow& row : fieldTable())
      if (!row.parameters.empty()) keys.push_back(row.name);
    checkKeys(table, path, keys);
    body.name = readName(table, path, "name");
    static constexpr ParameterSpec kRadius{"radius", Quantity::Length, kMinRadiusMeters, kMaxRadiusMeters, 0, ""};
    if (const toml::node* node = required(table, path, "radius", "a length with a unit: mm, m, km"))
      body.radiusMeters = readValue(*node, join(path, "radius"), kRadius);
    readPosition(table, path, body);
    readSchemes(table, path, body);
    readSeed(table, path, body);
    readField(table, path, fields, body);
    return body;
  }

  void readPosition(const toml::table& table, const std::string& path, Body& body) {
    const toml::node* node = table.get("position");
    if (!node) return;
    static constexpr std::string_view kExpected = R"(three lengths, as in ["384400 km", "0 km", "0 km"])";
    static constexpr ParameterSpec kCoordinate{"", Quantity::Length, -kMaxPositionMeters, kMaxPositionMeters, 0, ""};
    const toml::array* array = node->as_array();
    if (!array) return wrongType(*node, join(path, "position"), kExpected);
    if (array->size() != 3)
      return fail(node->source(), join(path, "position"),
                  fmt::format("has {} coordinates; expected {}", array->size(), kExpected));
    for (int axis = 0; axis < 3; ++axis)
      body.positionScene[axis] = readValue(*array->get(static_cast<std::size_t>(axis)),
                                           fmt::format("{}.position[{}]", path, axis), kCoordinate);
  }

  void checkPlaces(const toml::array& tables, std::span<const Body> bodies) {
    const std::optional<TouchingBodies> touching = findTouchingBodies(bodies);
    if (!touching) return;
    const toml::table& table = *tables.get(touching->second)->as_table();
    const toml::node* node = table.get("position");
    fail(node ? node->source() : table.source(), fmt::format("body[{}].position", touching->second),
         fmt::format("{} from the centre of body[{}] \"{}\"; allowed: more than {}, where their ground cannot touch",
                     formatQuantity(touching->distanceMeters, Quantity::Length), touching->first,
                     bodies[touching->first].name, formatQuantity(touching->neededMeters, Quantity::Length)));
  }

  void readSchemes(const toml::table& table, const std::string& path, Body& body) {
    const toml::node* node = table.get("schemes");
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array) return wrongType(*node, join(path, "schemes"), "an array of strings, as in [\"cube\"]");
    if (array->empty()) return fail(node->source(), join(path, "schemes"), "is empty; allowed: \"cube\", \"ico\"");
    body.schemes.clear();
    for (std::size_t i = 0; i < array->size(); ++i)
      readScheme(*array->get(i), fmt::format("{}.schemes[{}]", path, i), body);
  }

  void readScheme(const toml::node& node, const std::string& key, Body& body) {
    const std::optional<std::string> text = node.value_exact<std::string>();
    if (!text) return wrongType(node, key, "a string; allowed: \"cube\", \"ico\"");
    const bool cube = *text == schemeName(Scheme::Cube);
    if (!cube && *text != schemeName(Scheme::Ico))
      return fail(node.source(), key,
                  fmt::format("{} is not a tiling scheme; allowed: \"cube\", \"ico\"", quotedForMessage(*text)));
    const Scheme scheme = cube ? Scheme::Cube : Scheme::Ico;
    if (std::ranges::count(body.schemes, scheme) > 0)
      return fail(node.source(), key, fmt::format("\"{}\" is listed twice; allowed: each scheme once", *text));
    if (!body.schemes.empty())
      return fail(node.source(), key,
                  fmt::format("\"{}\" beside \"{}\" is not served yet; allowed: one scheme a body", *text,
                              schemeName(body.schemes.front())),
                  ErrorKind::Unsupported);
    body.schemes.push_back(scheme);
  }

  void readSeed(const toml::table& table, const std::string& path, Body& body) {
    const toml::node* node = table.get("seed");
    if (!node) return;
    const std::optional<std::int64_t> value = node->value_exact<std::int64_t>();
    if (!value) return wrongType(*node, join(path, "seed"), "an integer of at least 0");
    if (*value < 0)
      return fail(node->source(), join(path, "seed"),
                  fmt::format("{} is out of range; allowed: 0 to 2^63 - 1", *value));
    body.seed = static_cast<std::uint64_t>(*value);
  }

  void readField(const toml::table& table, const std::string& path, std::span<const std::string_view> fields,
                 Body& body) {
    const toml::node* node = required(table, path, "field", fmt::format("one of: {}", listOf(fields)));
    if (!node) return;
    const std::optional<std::string> text = node->value_exact<std::string>();
    if (!text) return wrongType(*node, join(path, "field"), fmt::format("a string, one of: {}", listOf(fields)));
    const std::optional<FieldKind> kind = findField(*text);
    if (!kind) return unknown(node->source(), join(path, "field"), *text, "field " + quotedForMessage(*text), fields);
    body.field = *kind;
    body.fieldParameters = defaultValues(fieldRow(*kind).parameters);
    for (const std::string_view name : fields) {
      const toml::node* settings = table.get(name);
      if (!settings) continue;
      if (name != *text)
        return fail(settings->source(), join(path, name),
                    fmt::format("these are settings of the field \"{}\", but this body's field is \"{}\"; allowed: {}",
                                name, *text, body.fieldParameters.empty() ? "none" : fmt::format("[body.{}]", *text)));
      readParameters(*settings, join(path, name), fieldRow(*kind).parameters, body.fieldParameters);
    }
    if (error_) return;  // of the radius or the scheme, too
    if (const Result<void> checked = checkHeightField(body); checked.has_error()) {
      const toml::node_view<const toml::node> value = table.at_path(checked.error().field);
      fail(value ? value.node()->source() : node->source(), join(path, checked.error().field), checked.error().message,
           checked.error().kind);
    }
  }

  void readEffects(const toml::table& root, std::vector<EffectCall>& effects) {
    const toml::node* node = root.get("effects");
    if (!node) return;
    const toml::table* table = node->as_table();
    if (!table) return wrongType(*node, "effects", "tables, written [effects.NAME]");
    const std::vector<std::string_view> names = namesOf(effectTable());
    const toml::key* first = nullptr;
    for (auto&& [key, value] : *table)
      if (!findEffect(key.str()) && (!first || key.source().begin < first->source().begin)) first = &key;
    if (first) return unknown(first->source(), join("effects", bareKey(first->str())), first->str(), "effect", names);
    for (const EffectRow& row : effectTable()) {
      const toml::node* settings = table->get(row.name);
      if (!settings) continue;
      EffectCall call{row.kind, defaultValues(row.parameters)};
      readParameters(*settings, join("effects", row.name), row.parameters, call.parameters);
      effects.push_back(std::move(call));
    }
  }

  void readParameters(const toml::node& node, const std::string& path, std::span<const ParameterSpec> schema,
                      ParameterValues& values) {
    const toml::table* table = node.as_table();
    if (!table) return wrongType(node, path, fmt::format("a table of settings: {}", listOf(namesOf(schema))));
    checkKeys(*table, path, namesOf(schema));
    for (const ParameterSpec& spec : schema)
      if (const toml::node* value = table->get(spec.name))
        values[std::string(spec.name)] = readValue(*value, join(path, spec.name), spec);
  }

  double readValue(const toml::node& node, std::string key, const ParameterSpec& spec) {
    std::optional<double> value;
    std::string found;
    if (spec.quantity == Quantity::Number || spec.quantity == Quantity::Integer) {
      const std::optional<std::int64_t> integer = node.value_exact<std::int64_t>();
      if (integer) value = static_cast<double>(*integer);
      if (!value && spec.quantity == Quantity::Number) value = node.value_exact<double>();
      if (!value)
        return wrongType(node, std::move(key), spec.quantity == Quantity::Number ? "a number" : "an integer"), 0;
      found = integer ? fmt::format("{}", *integer) : fmt::format("{}", *value);
    } else {
      const std::optional<std::string> text = node.value_exact<std::string>();
      if (!text && node.is_number()) return bareNumber(node, std::move(key), spec), 0;
      if (!text) {
        wrongType(node, std::move(key), fmt::format("a string with a unit; allowed: {}", allowedUnits(spec.quantity)));
        return 0;
      }
      const Result<double> parsed = parseQuantity(*text, spec.quantity);
      if (!parsed) return fail(node.source(), std::move(key), parsed.error().message), 0;
      value = *parsed;
      found = quotedForMessage(*text);
    }
    if (!std::isfinite(*value)) {
      fail(node.source(), std::move(key),
           fmt::format("{} is not a finite number; allowed: {}", found, rangeText(spec)));
      return 0;
    }
    if (*value < spec.minimum || *value > spec.maximum)
      fail(node.source(), std::move(key), fmt::format("{} is out of range; allowed: {}", found, rangeText(spec)));
    return *value;
  }

  static std::string rangeText(const ParameterSpec& spec) {
    return fmt::format("{} to {}", formatQuantity(spec.minimum, spec.quantity),
                       formatQuantity(spec.maximum, spec.quantity));
  }

  void bareNumber(const toml::node& node, std::string key, const ParameterSpec& spec) {
    const std::string number = fmt::format("{:.10g}", node.value<double>().value_or(0));
    fail(node.source(), std::move(key),
         fmt::format("{} has no unit; write a string such as \"{} {}\"; allowed: {}", number, number,
                     spec.quantity == Quantity::Angle ? "deg" : "m", allowedUnits(spec.quantity)));
  }

  std::string fileName_;
  std::optional<Error> error_;
};

std::string onOneLine(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return line;
}

}  // namespace

Result<Scene> parseScene(std::string_view toml, std::string_view fileName) try {
  if (std::optional<Error> error = checkSceneText(toml, fileName)) return *std::move(error);
  const toml::parse_result parsed = toml::parse(toml);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return makeError(
        ErrorKind::Malformed, "",
        fmt::format("{}:{}: not valid TOML: {}", fileName, std::max<toml::source_index>(error.source().begin.line, 1),
                    onOneLine(error.description())));
  }
  return SceneReader(fileName).read(parsed.table());
} catch (const std::exception& error) {
  return makeError(ErrorKind::Internal, "", fmt::format("{}: {}", fileName, error.what()));
}

}  // namespace terrane

#include "proto/json_cursor.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace terrane {
namespace {

/// Brackets open at once, outside strings. Also an upper bound for text that is no JSON.
int nestingDepth(std::string_view text) {
  int depth = 0, deepest = 0;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inString) {
      if (c == '\\') ++i;
      if (c == '"') inString = false;
    } else if (c == '"') {
      inString = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

std::string JsonCursor::childPath(std::string_view name) const {
  std::string path = path_;
  if (!path.empty()) path += '.';
  path += name;
  return path;
}

void JsonCursor::fail(std::string message, ErrorKind kind) const {
  if (!*error_) *error_ = makeError(kind, path_, std::move(message));
}

JsonCursor JsonCursor::member(std::string_view name) const {
  JsonCursor child(nullptr, childPath(name), error_);
  if (value_ == nullptr) return child;
  if (!value_->is_object()) {
    fail("not an object");
    return child;
  }
  const auto found = value_->find(name);
  if (found == value_->end()) {
    child.fail("missing");
  } else {
    child.value_ = &*found;
  }
  return child;
}

std::optional<JsonCursor> JsonCursor::optionalMember(std::string_view name) const {
  if (value_ == nullptr || !value_->is_object()) return std::nullopt;
  const auto found = value_->find(name);
  if (found == value_->end() || found->is_null()) return std::nullopt;
  return JsonCursor(&*found, childPath(name), error_);
}

JsonCursor JsonCursor::element(std::size_t index) const {
  JsonCursor child(nullptr, path_ + '[' + std::to_string(index) + ']', error_);
  if (value_ == nullptr) return child;
  if (!value_->is_array() || index >= value_->size()) {
    child.fail("missing");
  } else {
    child.value_ = &(*value_)[index];
  }
  return child;
}

std::size_t JsonCursor::arraySize(std::size_t minimum, std::size_t maximum) const {
  if (value_ == nullptr) return minimum;
  if (!value_->is_array()) {
    fail("not an array");
  } else if (value_->size() < minimum || value_->size() > maximum) {
    fail("an array of " + std::to_string(value_->size()) + " elements");
  } else {
    return value_->size();
  }
  return minimum;
}

double JsonCursor::number(double minimum, double maximum) const {
  if (value_ == nullptr) return minimum;
  if (!value_->is_number()) {
    fail("not a number");
    return minimum;
  }
  const double value = value_->get<double>();
  if (std::isfinite(value) && value >= minimum && value <= maximum) return value;
  fail("out of range");
  return minimum;
}

std::int64_t JsonCursor::integer(std::int64_t minimum, std::int64_t maximum) const {
  if (value_ == nullptr) return minimum;
  if (!value_->is_number_integer()) {
    fail("not an integer");
    return minimum;
  }
  const bool fits = !value_->is_number_unsigned() || value_->get<std::uint64_t>() <= INT64_MAX;
  const std::int64_t value = fits ? value_->get<std::int64_t>() : minimum;
  if (fits && value >= minimum && value <= maximum) return value;
  fail("out of range");
  return minimum;
}

std::string JsonCursor::text(std::size_t maxBytes) const {
  if (value_ == nullptr) return {};
  if (!value_->is_string()) {
    fail("not a string");
    return {};
  }
  const auto& value = value_->get_ref<const std::string&>();
  if (value.size() <= maxBytes) return value;
  fail("longer than " + std::to_string(maxBytes) + " bytes");
  return {};
}

struct JsonDocument::State {
  explicit State(nlohmann::json parsed) : json(std::move(parsed)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  nlohmann::json json;
  std::optional<Error> error;
};

JsonDocument::JsonDocument(std::unique_ptr<State> state) : state_(std::move(state)) {}
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

Result<JsonDocument> JsonDocument::parse(std::string_view text, const Limits& limits, std::string_view field) {
  if (text.size() > limits.maxBytes)
    return makeError(ErrorKind::TooLarge, std::string(field), "more bytes than the limit");
  if (nestingDepth(text) > limits.maxDepth)
    return makeError(ErrorKind::TooLarge, std::string(field), "nested too deep");
  auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return makeError(ErrorKind::Malformed, std::string(field), "not JSON");
  return JsonDocument(std::make_unique<State>(std::move(json)));
}

JsonCursor JsonDocument::root(std::string prefix) {
  return JsonCursor(&state_->json, std::move(prefix), &state_->error);
}

const std::optional<Error>& JsonDocument::error() const noexcept { return state_->error; }

}  // namespace terrane

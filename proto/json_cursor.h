#pragma once
// Reading JSON of unknown origin: a document that is bounded in bytes and nesting before it is parsed, and a cursor
// that walks it and keeps the first thing that was wrong, named by its key ("bodies[0].radiusMeters"), so that reading
// code is a plain list of members. After an error every read answers a value within its stated range. Private to proto.
// A document may be read by one thread at a time.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

/// A place in a document. Cheap to copy; valid as long as the document.
class JsonCursor {
 public:
  /// The member of an object; an error if it is absent.
  JsonCursor member(std::string_view name) const;
  /// Empty if it is absent or null.
  std::optional<JsonCursor> optionalMember(std::string_view name) const;
  JsonCursor element(std::size_t index) const;

  /// Of an array; an error unless it is within the bounds.
  std::size_t arraySize(std::size_t minimum, std::size_t maximum) const;
  double number(double minimum, double maximum) const;
  std::int64_t integer(std::int64_t minimum, std::int64_t maximum) const;
  std::string text(std::size_t maxBytes) const;

  /// Keeps an error at this place unless there is one already.
  void fail(std::string message, ErrorKind kind = ErrorKind::Malformed) const;
  /// Names this place, and what is below it, otherwise from now on.
  void rename(std::string path) { path_ = std::move(path); }
  bool ok() const noexcept { return !*error_; }

 private:
  friend class JsonDocument;
  JsonCursor(const nlohmann::json* value, std::string path, std::optional<Error>* error)
      : value_(value), path_(std::move(path)), error_(error) {}
  std::string childPath(std::string_view name) const;

  const nlohmann::json* value_;  ///< null after an error
  std::string path_;
  std::optional<Error>* error_;
};

class JsonDocument {
 public:
  struct Limits {
    std::size_t maxBytes;
    int maxDepth;
  };
  /// Errors: TooLarge, Malformed, naming field.
  static Result<JsonDocument> parse(std::string_view text, const Limits& limits, std::string_view field);

  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;
  ~JsonDocument();

  /// Members are named prefix.member, or member alone if the prefix is empty.
  JsonCursor root(std::string prefix);
  const std::optional<Error>& error() const noexcept;

 private:
  struct State;
  explicit JsonDocument(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane

#pragma once
// Result<T>: what every function returns that can fail on input. No exceptions cross a public function of Terrane;
// those of libraries are caught where the library is called. Values of these types may be moved between threads.

#include <boost/system/result.hpp>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace terrane {

enum class ErrorKind : std::uint8_t {
  InvalidArgument,  ///< the caller's value is not of the right form or range
  NotFound,
  Malformed,    ///< bytes or text that do not decode
  Unsupported,  ///< well formed, but beyond what this build does
  TooLarge,     ///< a stated limit was exceeded
  Gone,         ///< an old revision
  Overloaded,   ///< try again later
  Timeout,
  Cancelled,
  Io,        ///< file, socket, display
  Internal,  ///< a bug, or memory ran out
};

std::string_view errorKindName(ErrorKind kind) noexcept;

/// In quotes, on one line, control characters and what is not UTF-8 escaped, cut at 60 bytes.
std::string quotedForMessage(std::string_view text);

/// field names what was wrong as the user wrote it: a flag ("--listen"), a key ("body[0].radius"), a part of a URL
/// ("face").
struct Error {
  ErrorKind kind = ErrorKind::Internal;
  std::string field;
  std::string message;

  /// "field: message", or the message alone.
  std::string text() const { return field.empty() ? message : field + ": " + message; }
};

/// Found by boost::system::result; reached only by calling value() on an error, which is a bug in the caller.
[[noreturn]] inline void throw_exception_from_error(const Error& error, const boost::source_location&) {
  throw std::logic_error("unchecked error: " + error.text());
}

template <class T>
using Result = boost::system::result<T, Error>;

inline Error makeError(ErrorKind kind, std::string field, std::string message) {
  return Error{kind, std::move(field), std::move(message)};
}

}  // namespace terrane

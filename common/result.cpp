#include "common/result.h"

#include <fmt/format.h>

namespace terrane {

std::string_view errorKindName(ErrorKind kind) noexcept {
  switch (kind) {
    case ErrorKind::InvalidArgument:
      return "invalid-argument";
    case ErrorKind::NotFound:
      return "not-found";
    case ErrorKind::Malformed:
      return "malformed";
    case ErrorKind::Unsupported:
      return "unsupported";
    case ErrorKind::TooLarge:
      return "too-large";
    case ErrorKind::Gone:
      return "gone";
    case ErrorKind::Overloaded:
      return "overloaded";
    case ErrorKind::Timeout:
      return "timeout";
    case ErrorKind::Cancelled:
      return "cancelled";
    case ErrorKind::Io:
      return "io";
    case ErrorKind::Internal:
      return "internal";
  }
  return "internal";
}

std::string quotedForMessage(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string quoted = "\"";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      quoted += {'\\', c};
    else if (byte < 0x20 || byte >= 0x7f)
      quoted += fmt::format("\\x{:02x}", byte);
    else
      quoted += c;
  }
  quoted += text.size() > kLongest ? "...\"" : "\"";
  return quoted;
}

}  // namespace terrane

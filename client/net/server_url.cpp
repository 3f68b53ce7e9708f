#include "client/net/server_url.h"

#include <algorithm>
#include <charconv>

namespace terrane {
namespace {

constexpr std::string_view kScheme = "http://";
constexpr std::size_t kMaxHostBytes = 253;  // RFC 1035, in text form

Error wrong(std::string_view text, std::string_view why) {
  constexpr std::size_t kShown = 80;
  std::string shown(text.substr(0, kShown));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  if (text.size() > kShown) shown += "...";
  return makeError(
      ErrorKind::InvalidArgument, "--server",
      "\"" + shown + "\" " + std::string(why) + "; expected http://HOST[:PORT], e.g. http://127.0.0.1:8080");
}

bool startsWithIgnoringCase(std::string_view text, std::string_view lowerPrefix) {
  if (text.size() < lowerPrefix.size()) return false;
  return std::equal(lowerPrefix.begin(), lowerPrefix.end(), text.begin(),
                    [](char expected, char c) { return expected == (c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isHexDigit(char c) { return isDigit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }
bool isNameCharacter(char c) {
  return isDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '.' || c == '_';
}
std::string bracketed(const std::string& host) { return host.find(':') == std::string::npos ? host : "[" + host + "]"; }

}  // namespace

std::string ServerUrl::authority() const {
  return port == 80 ? bracketed(host) : bracketed(host) + ":" + std::to_string(port);
}

std::string ServerUrl::origin() const { return std::string(kScheme) + bracketed(host) + ":" + std::to_string(port); }

Result<ServerUrl> parseServerUrl(std::string_view text) {
  if (startsWithIgnoringCase(text, "https://")) return wrong(text, "asks for TLS, which this viewer does not speak");
  if (!startsWithIgnoringCase(text, kScheme)) return wrong(text, "does not begin with http://");
  std::string_view rest = text.substr(kScheme.size());
  if (rest.ends_with('/')) rest.remove_suffix(1);

  ServerUrl url;
  if (rest.starts_with('[')) {
    const std::size_t close = rest.find(']');
    if (close == std::string_view::npos) return wrong(text, "has no closing bracket");
    url.host = rest.substr(1, close - 1);
    if (url.host.find(':') == std::string::npos ||
        !std::all_of(url.host.begin(), url.host.end(), [](char c) { return isHexDigit(c) || c == ':' || c == '.'; })) {
      return wrong(text, "has no IPv6 address between its brackets");
    }
    rest.remove_prefix(close + 1);
  } else {
    const auto end = std::find_if_not(rest.begin(), rest.end(), isNameCharacter);
    url.host = std::string(rest.begin(), end);
    rest.remove_prefix(url.host.size());
    if (url.host.empty()) return wrong(text, "has no host");
  }
  if (url.host.size() > kMaxHostBytes) return wrong(text, "has too long a host");
  if (rest.empty()) return url;
  if (rest.front() != ':') return wrong(text, "has something after the host that is no port");

  rest.remove_prefix(1);
  unsigned port = 0;
  const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), port);
  if (failure != std::errc() || end != rest.data() + rest.size() || port == 0 || port > 65535) {
    return wrong(text, "has no port from 1 to 65535 after its colon");
  }
  url.port = static_cast<std::uint16_t>(port);
  return url;
}

}  // namespace terrane

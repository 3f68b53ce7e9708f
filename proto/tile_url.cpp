#include "proto/tile_url.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace terrane {
namespace {

constexpr std::string_view kTileSuffix = ".glb";
constexpr std::size_t kMaxSegments = 6;

Error invalid(const char* field, std::string message) {
  return makeError(ErrorKind::InvalidArgument, field, std::move(message));
}
Error notFound() { return makeError(ErrorKind::NotFound, "target", "no such path"); }

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// RFC 3986 section 2.3: an escape of these is the same as the character.
bool isUnreserved(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.' ||
         c == '_' || c == '~';
}

/// The path alone, of origin-form or absolute-form (RFC 9112 section 3.2), without the query.
std::string_view pathOf(std::string_view target) {
  for (const std::string_view scheme : {std::string_view("http://"), std::string_view("https://")}) {
    if (target.starts_with(scheme)) {
      const std::size_t slash = target.find_first_of("/?", scheme.size());
      target = slash == std::string_view::npos || target[slash] == '?' ? std::string_view("/") : target.substr(slash);
      break;
    }
  }
  return target.substr(0, target.find('?'));
}

bool isVisibleAscii(char c) { return c > ' ' && c <= '~'; }

/// Undoes escapes of unreserved characters, reads "//" as "/", refuses what no route can hold.
Result<std::string> normalise(std::string_view path) {
  if (path.empty() || path.front() != '/') return invalid("target", "does not begin with /");
  std::string out;
  out.reserve(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    char c = path[i];
    if (c == '%') {
      const int high = i + 1 < path.size() ? hexDigit(path[i + 1]) : -1;
      const int low = i + 2 < path.size() ? hexDigit(path[i + 2]) : -1;
      if (high < 0 || low < 0) return invalid("target", "a % without two hexadecimal digits");
      c = static_cast<char>(16 * high + low);
      if (!isUnreserved(c)) return invalid("target", "an escaped character that no path here holds");
      i += 2;
    } else if (c == '#' || c == '\\') {
      return invalid("target", "a character that no path here holds");
    }
    if (c == '/' && !out.empty() && out.back() == '/') continue;
    out.push_back(c);
  }
  return out;
}

bool hasDotSegment(std::string_view path) {
  const auto holds = [&](std::string_view segment) {
    return path.ends_with(segment) || path.find(std::string(segment) + '/') != std::string_view::npos;
  };
  return holds("/.") || holds("/..");
}

/// The segments between slashes; empty if there are more than any route has.
std::optional<std::span<const std::string_view>> splitSegments(std::string_view path,
                                                               std::array<std::string_view, kMaxSegments>& storage) {
  std::size_t count = 0;
  for (std::size_t begin = 1; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (count == kMaxSegments) return std::nullopt;
    storage[count++] = path.substr(begin, end - begin);
    begin = end + 1;
  }
  return std::span<const std::string_view>(storage.data(), count);
}

bool isRevision(std::string_view text) {
  return text.size() >= 8 && text.size() <= 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}
bool isBodyName(std::string_view text) {
  return !text.empty() && text.size() <= 32 &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string_view::npos;
}

/// {revision}/{body}/{scheme}/{face}.glb or {revision}/{body}/{scheme}/{face}/{digits}.glb
Result<Route> parseTile(std::span<const std::string_view> parts) {
  if (!isRevision(parts[0])) return invalid("revision", "8 to 64 of 0-9 and a-f");
  if (!isBodyName(parts[1])) return invalid("body", "1 to 32 of a-z, 0-9 and -");
  const std::string_view last = parts.back().substr(0, parts.back().size() - kTileSuffix.size());
  const bool wholeFace = parts.size() == 4;
  if (!wholeFace && last.empty()) return invalid("digits", "none before .glb");
  auto path = FacePath::fromParts(parts[2], wholeFace ? last : parts[3], wholeFace ? std::string_view() : last);
  if (!path) return path.error();
  return Route(TileAddress{std::string(parts[0]), std::string(parts[1]), *path});
}

}  // namespace

Result<Route> parseTarget(std::string_view target) {
  if (target.size() > kMaxTargetBytes) return makeError(ErrorKind::TooLarge, "target", "longer than 2048 bytes");
  if (!std::all_of(target.begin(), target.end(), isVisibleAscii))
    return invalid("target", "a control character or one beyond ASCII");
  auto path = normalise(pathOf(target));
  if (!path) return path.error();
  if (*path == "/") return Route(RootPage{});
  if (*path == "/healthz") return Route(HealthCheck{});
  if (*path == "/readyz") return Route(ReadyCheck{});
  if (*path == "/metrics") return Route(Metrics{});
  if (*path == kSceneTarget) return Route(SceneDocument{});

  if (hasDotSegment(*path)) return invalid("target", "dot segments");

  std::array<std::string_view, kMaxSegments> storage;
  const auto segments = splitSegments(*path, storage);
  if (!segments) return notFound();
  if ((*segments)[0] != "v1" || !segments->back().ends_with(kTileSuffix)) return notFound();
  const auto parts = segments->subspan(1);
  if (parts.size() != 4 && parts.size() != 5) return notFound();
  return parseTile(parts);
}

std::string tileTarget(const TileAddress& address) {
  std::string target = "/v1/";
  target += address.revision;
  target += '/';
  target += address.body;
  target += '/';
  target += address.path.text();
  target += kTileSuffix;
  return target;
}

}  // namespace terrane

#pragma once
// The targets of HTTP requests: one grammar for server and client. "//" is read as "/", escapes of unreserved
// characters as those characters, "http://host/path" as "/path"; a query is ignored, since clients add their own.
// Thread-safe.
//   /v1/scene.json
//   /v1/{revision}/{body}/{scheme}/{face}[/{digits}].glb
// Faces of the scheme cube are 0 to 5, of ico 0 to 19; digits of both 0 to 3 (face_path.h).

#include <string>
#include <string_view>
#include <variant>

#include "common/result.h"
#include "common/tiling/face_path.h"

namespace terrane {

inline constexpr std::size_t kMaxTargetBytes = 2048;

struct RootPage {};
struct HealthCheck {};
struct ReadyCheck {};
struct Metrics {};
struct SceneDocument {};
struct TileAddress {
  std::string revision;
  std::string body;
  FacePath path;
};
using Route = std::variant<RootPage, HealthCheck, ReadyCheck, Metrics, SceneDocument, TileAddress>;

/// Any bytes. Errors: NotFound for a path that is no route; TooLarge ("target") beyond kMaxTargetBytes; InvalidArgument
/// naming "face", "digits", "scheme", "body", "revision", or "target" (dot segments, a character or an escape that no
/// route can hold).
Result<Route> parseTarget(std::string_view target);

std::string tileTarget(const TileAddress& address);
inline constexpr std::string_view kSceneTarget = "/v1/scene.json";

}  // namespace terrane

#pragma once
// Scene files (TOML) with full validation. An error says file, line, key, what was found and what is allowed.
// Thread-safe.
//
//   name = "moon"
//   summary = "The Moon, from orbit to its dust"
//   [[body]]
//   name = "moon"
//   radius = "1737.4 km"        # units: mm m km; angles: deg rad
//   schemes = ["cube"]          # or ["ico"]: the tiling, one a body
//   seed = 1969
//   field = "lunar"
//   position = ["0 km", "0 km", "0 km"]  # of its centre in the scene, whose axes are the body's; this is the default
//   [body.lunar]                # the field's settings, all with defaults
//   [effects.sun]
//   longitude = "40 deg"
//   latitude = "2 deg"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "common/scene/scene.h"

namespace terrane {

inline constexpr std::size_t kMaxSceneFileBytes = 64 * 1024;
inline constexpr std::size_t kMaxSceneLineBytes = 1000;
inline constexpr std::size_t kMaxSceneBodies = 64;

/// Errors: one line, complete in message: "moon.toml:4: body[0].radius: "17 parsec" has an unknown unit; allowed: mm,
/// m, km"; field is the key path ("body[0].radius"), empty for what is no TOML. Kinds: InvalidArgument, Malformed
/// (syntax, encoding), TooLarge (ground too steep for its body, too), Unsupported (two schemes). Bodies whose ground
/// might touch are refused at the position of the later one.
Result<Scene> parseScene(std::string_view toml, std::string_view fileName);
/// Errors also: Io, naming the file in message and field.
Result<Scene> loadSceneFile(const std::filesystem::path& file);

/// A name that ships with the server ("moon", "moon-ico", "fractal", "smooth") or a path to a .toml file. Errors also:
/// NotFound, field "--scene".
Result<Scene> loadScene(std::string_view nameOrFile);
std::vector<std::string> shippedScenes();

}  // namespace terrane

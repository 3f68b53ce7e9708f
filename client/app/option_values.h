#pragma once
// What values of terrane-view's flags say: text as a person writes it to plain numbers, metres and radians. Errors are
// InvalidArgument and name the flag. Thread-safe.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/result.h"
#include "common/scene/effects.h"
#include "common/view/camera.h"

namespace terrane {

/// An InvalidArgument error.
Error flagError(std::string_view flag, std::string message);

/// "1280x720", each side 16..16384. Errors name "--size".
Result<std::pair<int, int>> parseSize(std::string_view text);
/// "LON,LAT,ALT[,HEADING[,PITCH]]" in degrees and metres; heading 0 and pitch -90 where not given. Errors name
/// "--camera".
Result<ViewPose> parseCamera(std::string_view text);
/// A size (common/byte_size.h) of at least 1 MiB. Errors (TooLarge, too) name the flag.
Result<std::size_t> parseBudget(std::string_view text, std::string_view flag);
/// "2MB/s", "500KB/s", "2MiB/s", or bytes per second; 1 KB/s to 1000 GB/s, or 0. Errors name "--bandwidth".
Result<std::uint64_t> parseBandwidth(std::string_view text);
/// Names of --without.
Result<std::vector<EffectKind>> parseEffects(const std::vector<std::string>& names);
/// --msaa: "auto" (empty), "off", "1", "2", "4", "8".
Result<std::optional<int>> parseSamples(std::string_view text);

}  // namespace terrane

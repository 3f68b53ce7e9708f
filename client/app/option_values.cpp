#include "client/app/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "client/net/simulated_link.h"
#include "common/byte_size.h"
#include "common/command_line.h"

namespace terrane {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

std::optional<double> parseNumber(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

Error flagError(std::string_view flag, std::string message) {
  return makeError(ErrorKind::InvalidArgument, std::string(flag), std::move(message));
}

Result<std::vector<EffectKind>> parseEffects(const std::vector<std::string>& names) {
  std::vector<EffectKind> kinds;
  for (const std::string& name : names) {
    const auto kind = findEffect(name);
    if (!kind) {
      std::string known;
      for (const EffectRow& row : effectTable()) known += (known.empty() ? "" : ", ") + std::string(row.name);
      return flagError("--without", fmt::format("{} is no effect: there are {}", quotedForMessage(name), known));
    }
    kinds.push_back(*kind);
  }
  return kinds;
}

Result<std::optional<int>> parseSamples(std::string_view text) {
  if (text == "auto") return std::optional<int>();
  constexpr std::array<std::pair<std::string_view, int>, 5> kNames{
      {{"off", 1}, {"1", 1}, {"2", 2}, {"4", 4}, {"8", 8}}};
  for (const auto& [name, samples] : kNames)
    if (name == text) return std::optional<int>(samples);
  return flagError("--msaa", fmt::format("'{}' is none of auto, off, 1, 2, 4, 8", text));
}

Result<std::pair<int, int>> parseSize(std::string_view text) {
  const std::size_t x = text.find('x');
  const auto side = [](std::string_view part) {
    int value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return error == std::errc() && end == part.data() + part.size() && value >= 16 && value <= 16384 ? value : 0;
  };
  const int width = x == std::string_view::npos ? 0 : side(text.substr(0, x));
  const int height = x == std::string_view::npos ? 0 : side(text.substr(x + 1));
  if (width == 0 || height == 0)
    return flagError("--size", fmt::format("\"{}\" is no size: write it as 1280x720, each side 16 to 16384", text));
  return std::pair{width, height};
}

Result<ViewPose> parseCamera(std::string_view text) {
  const auto wrong = [&](std::string_view why) {
    return flagError("--camera",
                     fmt::format("\"{}\": {} (LON,LAT,ALT[,HEADING,PITCH], degrees and metres)", text, why));
  };
  std::array<double, 5> values{0, 0, 0, 0, -90};
  std::size_t count = 0;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const auto number = parseNumber(rest.substr(0, comma));
    if (!number) return wrong(fmt::format("\"{}\" is no number", rest.substr(0, comma)));
    if (count == values.size()) return wrong("more than five numbers");
    values[count++] = *number;
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (count < 3) return wrong("at least three numbers are needed");
  if (std::abs(values[0]) > 360) return wrong("the longitude is out of range: -360 to 360");
  if (std::abs(values[1]) > 90) return wrong("the latitude is out of range: -90 to 90");
  if (std::abs(values[2]) > 1e12) return wrong("the altitude is out of range: at most 1e12 m");
  if (std::abs(values[3]) > 360) return wrong("the heading is out of range: -360 to 360");
  if (std::abs(values[4]) > 90) return wrong("the pitch is out of range: -90 to 90");
  return ViewPose{values[0] * kRadiansPerDegree, values[1] * kRadiansPerDegree, values[2],
                  values[3] * kRadiansPerDegree, values[4] * kRadiansPerDegree};
}

Result<std::size_t> parseBudget(std::string_view text, std::string_view flag) {
  constexpr std::size_t kLeast = 1u << 20;
  const auto bytes = parseByteSize(text, flag);
  if (bytes && *bytes < kLeast)
    return flagError(flag, fmt::format("\"{}\" is out of range: {} or more", text, formatByteSize(kLeast)));
  return bytes;
}

Result<std::uint64_t> parseBandwidth(std::string_view text) {
  constexpr std::string_view kFlag = "--bandwidth";
  const std::size_t unitAt = std::min(text.find_first_not_of("0123456789."), text.size());
  const auto number = parseNumber(text.substr(0, unitAt));
  const std::string_view unit = text.substr(unitAt);
  double scale = 0;
  for (const auto& [name, bytes] : {std::pair{"", 1.0}, std::pair{"B/s", 1.0}, std::pair{"KB/s", 1e3},
                                    std::pair{"MB/s", 1e6}, std::pair{"GB/s", 1e9}, std::pair{"KiB/s", 1024.0},
                                    std::pair{"MiB/s", 1048576.0}, std::pair{"GiB/s", 1073741824.0}})
    if (unit == name) scale = bytes;
  if (!number || scale == 0)
    return flagError(kFlag,
                     fmt::format("\"{}\" is no bandwidth: write it as 2MB/s, 500KiB/s or in bytes per second", text));
  const double bytesPerSecond = *number * scale;
  if (bytesPerSecond == 0) return std::uint64_t{0};
  if (bytesPerSecond < 1e3 || bytesPerSecond > static_cast<double>(SimulatedLink::kMostBytesPerSecond))
    return flagError(kFlag, fmt::format("\"{}\" is out of range: 1KB/s to 1000GB/s, or 0 for off", text));
  return static_cast<std::uint64_t>(bytesPerSecond);
}

}  // namespace terrane

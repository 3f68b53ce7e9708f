#include "client/render/readable_units.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace terrane {
namespace {

// 0.2, 1.25, 12.5, 125, 1250: at least three digits before rounding, no trailing zeros.
std::string shortNumber(double value) {
  const double size = std::abs(value);
  if (size >= 9999.5)
    return fmt::format("{}{}", value < 0 ? "-" : "", countText(static_cast<std::uint64_t>(std::llround(size))));
  std::string text = fmt::format("{:.{}f}", value, size < 9.995 ? 2 : size < 99.95 ? 1 : 0);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

}  // namespace

std::string countText(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
  return text;
}

std::string lengthText(double meters) {
  if (!std::isfinite(meters)) return "-";
  if (std::abs(meters) < 0.1 && meters != 0) return shortNumber(meters * 1000) + " mm";
  if (std::abs(meters) < 999.5) return shortNumber(meters) + " m";
  return shortNumber(meters / 1000) + " km";
}

std::string speedText(double metersPerSecond) { return lengthText(metersPerSecond) + "/s"; }

std::string bytesText(std::uint64_t bytes) {
  static constexpr std::array kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1023.5 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
  return fmt::format("{} {}", shortNumber(value), kUnits[unit]);
}

}  // namespace terrane

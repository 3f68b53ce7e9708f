#include "server/scenes/quantity_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace terrane {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Unit {
  std::string_view name;
  int decimalExponent;  // lengths: metres = number * 10^decimalExponent, done in the decimal text and so without a
                        // second rounding
  double factor;        // angles: radians = number * factor
};
constexpr std::array kLengthUnits{Unit{"mm", -3, 1}, Unit{"m", 0, 1}, Unit{"km", 3, 1}};
constexpr std::array kAngleUnits{Unit{"deg", 0, kDegree}, Unit{"rad", 0, 1}};

std::span<const Unit> unitsOf(Quantity quantity) {
  if (quantity == Quantity::Length) return kLengthUnits;
  if (quantity == Quantity::Angle) return kAngleUnits;
  return {};
}

bool isNumberCharacter(char c) {
  return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

/// A finite decimal number times 10^shift, correctly rounded.
std::optional<double> parseDecimal(std::string_view text, int shift) {
  if (text.empty() || !(text[0] == '-' || (text[0] >= '0' && text[0] <= '9'))) return std::nullopt;
  const std::size_t mark = text.find_first_of("eE");
  int exponent = 0;
  if (mark != std::string_view::npos) {
    std::string_view digits = text.substr(mark + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [rest, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (failure != std::errc() || rest != digits.data() + digits.size() || std::abs(exponent) > 400)
      return std::nullopt;
  }
  const std::string shifted = fmt::format("{}e{}", text.substr(0, mark), exponent + shift);
  double value = 0;
  const auto [rest, failure] = std::from_chars(shifted.data(), shifted.data() + shifted.size(), value);
  if (failure != std::errc() || rest != shifted.data() + shifted.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Insertions, deletions, replacements and swaps of neighbours (optimal string alignment).
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, above, row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(above, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string_view allowedUnits(Quantity quantity) noexcept {
  if (quantity == Quantity::Length) return "mm, m, km";
  if (quantity == Quantity::Angle) return "deg, rad";
  return "";
}

Result<double> parseQuantity(std::string_view text, Quantity quantity) {
  const auto wrong = [&](std::string_view what) {
    return makeError(ErrorKind::InvalidArgument, "",
                     fmt::format("{} {}; allowed: {}", quotedForMessage(text), what, allowedUnits(quantity)));
  };
  const auto numberEnd = std::ranges::find_if_not(text, isNumberCharacter);
  std::string_view number = text.substr(0, static_cast<std::size_t>(numberEnd - text.begin()));
  if (number.empty()) return wrong("does not begin with a number and end with a unit");
  std::string_view unitName = text.substr(number.size());
  while (unitName.starts_with(' ')) unitName.remove_prefix(1);
  while (unitName.ends_with(' ')) unitName.remove_suffix(1);
  if (unitName.empty()) return wrong("has no unit");
  const auto units = unitsOf(quantity);
  const auto unit = std::ranges::find(units, unitName, &Unit::name);
  if (unit == units.end()) {
    const bool otherKind = std::ranges::count(kLengthUnits, unitName, &Unit::name) > 0 ||
                           std::ranges::count(kAngleUnits, unitName, &Unit::name) > 0;
    return wrong(!otherKind                    ? "has an unknown unit"
                 : quantity == Quantity::Angle ? "has a unit of length, not of angle"
                                               : "has a unit of angle, not of length");
  }
  const std::optional<double> value = parseDecimal(number, unit->decimalExponent);
  if (!value) return wrong("is not a number and a unit");
  return *value * unit->factor;
}

std::string formatQuantity(double value, Quantity quantity) {
  switch (quantity) {
    case Quantity::Length: {
      const double magnitude = std::abs(value);
      if (magnitude >= 1000) return fmt::format("{:.10g} km", value / 1000);
      if (magnitude > 0 && magnitude < 0.1) return fmt::format("{:.10g} mm", value * 1000);
      return fmt::format("{:.10g} m", value);
    }
    case Quantity::Angle:
      return fmt::format("{:.10g} deg", value / kDegree);
    case Quantity::Number:
    case Quantity::Integer:
      break;
  }
  return fmt::format("{:.10g}", value);
}

std::string_view nearestWord(std::string_view word, std::span<const std::string_view> candidates) {
  std::string_view nearest;
  std::size_t best = std::min<std::size_t>(3, word.size() / 2 + 1);  // one more than is accepted
  if (word.size() > 40) return nearest;
  for (const std::string_view candidate : candidates) {
    const std::size_t distance = editDistance(word, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace terrane

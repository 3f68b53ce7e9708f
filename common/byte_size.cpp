#include "common/byte_size.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>

namespace terrane {
namespace {

struct Unit {
  std::string_view name;
  std::uint64_t bytes;
};
constexpr std::array kUnits{Unit{"B", 1},
                            Unit{"KiB", 1ull << 10},
                            Unit{"MiB", 1ull << 20},
                            Unit{"GiB", 1ull << 30},
                            Unit{"TiB", 1ull << 40},
                            Unit{"kB", 1000},
                            Unit{"MB", 1000'000},
                            Unit{"GB", 1000'000'000},
                            Unit{"TB", 1000'000'000'000}};

}  // namespace

Result<std::size_t> parseByteSize(std::string_view text, std::string_view field) {
  const auto wrong = [&](ErrorKind kind, std::string_view what) {
    return makeError(
        kind, std::string(field),
        fmt::format(
            "\"{}\" {}; write a number and a unit, as in 256MiB or 1.5GiB (units: B, KiB, MiB, GiB, TiB, kB, MB, "
            "GB, TB)",
            text.substr(0, 40), what));
  };
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  auto [rest, failure] = std::from_chars(text.data(), end, number);
  if (failure == std::errc::result_out_of_range) return wrong(ErrorKind::TooLarge, "is too large");
  if (failure != std::errc()) return wrong(ErrorKind::InvalidArgument, "is not a size");
  double part = 0;  // behind the point
  if (rest != end && *rest == '.') {
    const char* const first = rest;
    const auto fraction = std::from_chars(first, end, part, std::chars_format::fixed);
    if (fraction.ec != std::errc() || fraction.ptr == first + 1)
      return wrong(ErrorKind::InvalidArgument, "is not a size");
    rest = fraction.ptr;
  }
  std::string_view unitName(rest, static_cast<std::size_t>(end - rest));
  if (unitName.starts_with(' ')) unitName.remove_prefix(1);
  if (unitName.empty() && rest == end) unitName = "B";
  const auto unit = std::ranges::find(kUnits, unitName, &Unit::name);
  if (unit == kUnits.end()) return wrong(ErrorKind::InvalidArgument, "is not a size");
  if (number >= std::numeric_limits<std::size_t>::max() / unit->bytes)
    return wrong(ErrorKind::TooLarge, "is too large");
  if (part > 0 && unit->bytes == 1) return wrong(ErrorKind::InvalidArgument, "is no whole number of bytes");
  return static_cast<std::size_t>(number * unit->bytes +
                                  static_cast<std::uint64_t>(part * static_cast<double>(unit->bytes)));
}

std::string formatByteSize(std::size_t bytes) {
  for (const Unit& unit : {kUnits[4], kUnits[3], kUnits[2], kUnits[1]}) {
    if (bytes < unit.bytes) continue;
    if (bytes % unit.bytes == 0) return fmt::format("{} {}", bytes / unit.bytes, unit.name);
    return fmt::format("{:.1f} {}", static_cast<double>(bytes) / static_cast<double>(unit.bytes), unit.name);
  }
  return fmt::format("{} B", bytes);
}

}  // namespace terrane

#pragma once
// Quantities as scene files write them: a decimal number and a unit, "1737.4 km", "30 deg". Metres and radians inside.
// Thread-safe.

#include <span>
#include <string>
#include <string_view>

#include "common/result.h"
#include "common/scene/parameters.h"

namespace terrane {

/// "mm, m, km" or "deg, rad"; empty for quantities without a unit.
std::string_view allowedUnits(Quantity quantity) noexcept;

/// Lengths are correctly rounded: "1737.4 km" is exactly the double nearest 1737400. Errors (InvalidArgument) quote the
/// text and list the units; their field is empty.
Result<double> parseQuantity(std::string_view text, Quantity quantity);

/// The shortest text that parseQuantity reads as a value this close: "1737.4 km", "250 m", "52 deg", "0.02".
std::string formatQuantity(double value, Quantity quantity);

/// The candidate that is a typing mistake away (at most two edits, fewer for short words), or empty.
std::string_view nearestWord(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace terrane

#pragma once
// Named, typed, ranged settings of fields and effects. One schema row per setting serves the scene file's validation,
// scene.json and --explain, so that a setting is described once. Thread-safe.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace terrane {

/// What a setting measures. In a scene file lengths and angles are strings with a unit ("1737.4 km", "30 deg"); in here
/// they are metres and radians.
enum class Quantity : std::uint8_t { Number, Integer, Length, Angle };

struct ParameterSpec {
  std::string_view name;
  Quantity quantity = Quantity::Number;
  double minimum = 0, maximum = 0;  ///< inclusive; metres, radians
  double defaultValue = 0;
  std::string_view summary;
};

/// Every parameter of the schema is present once a scene was read.
using ParameterValues = std::map<std::string, double, std::less<>>;

ParameterValues defaultValues(std::span<const ParameterSpec> schema);

}  // namespace terrane

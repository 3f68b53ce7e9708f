// The one table of height fields and their settings.

#include <array>

#include "common/scene/scene.h"

namespace terrane {
namespace {

constexpr std::array kLunarParameters{
    ParameterSpec{"mare-fraction", Quantity::Number, 0.0, 0.5, 0.17,
                  "share of the surface that lava has flooded, roughly; 0 dries the maria"},
    ParameterSpec{"crater-density", Quantity::Number, 0.0, 1.0, 0.9,
                  "share of the places for a crater that hold one; 1 is saturated ground"},
    ParameterSpec{"roughness", Quantity::Number, 0.0, 2.0, 1.0, "scales hills and regolith between the craters"},
    ParameterSpec{"rock-density", Quantity::Number, 0.0, 4.0, 1.0, "scales the number of boulders, stones and grains"},
    ParameterSpec{"finest-detail", Quantity::Length, 0.001, 1000.0, 0.001, "wavelength of the smallest features"},
};

constexpr std::array kMidpointParameters{
    ParameterSpec{"amplitude", Quantity::Length, 0.0, 1e6, 1000.0,
                  "the solid's corners lie that far up or down at most, the vertices new at grid level l by "
                  "2^-l l^regularity of it beside their surroundings"},
    ParameterSpec{"regularity", Quantity::Number, 0.0, 3.0, 1.0,
                  "how much rougher fine detail is than coarse; 0 is fractal ground, alike at all scales"},
};

constexpr std::array<FieldRow, kFieldKindCount> kFields{{
    {FieldKind::Sphere, "sphere", "a bare sphere", {}},
    {FieldKind::Lunar, "lunar", "maria, highlands, craters, regolith and rocks, from basins to grains",
     kLunarParameters},
    {FieldKind::Midpoint, "midpoint", "fractal ground: edges are halved and their middles moved, level by level",
     kMidpointParameters},
}};

}  // namespace

std::span<const FieldRow> fieldTable() noexcept { return kFields; }

const FieldRow& fieldRow(FieldKind kind) noexcept { return kFields[static_cast<std::size_t>(kind)]; }

std::optional<FieldKind> findField(std::string_view name) noexcept {
  for (const FieldRow& row : kFields) {
    if (row.name == name) return row.kind;
  }
  return std::nullopt;
}

}  // namespace terrane

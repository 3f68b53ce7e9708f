#include "client/render/placement.h"

#include <fmt/format.h>

namespace terrane {
namespace {

struct PlacementName {
  Placement placement;
  std::string_view name;
};
constexpr PlacementName kNames[] = {{Placement::Integer, "integer"},
                                    {Placement::DoubleFloat, "double-float"},
                                    {Placement::Cpu, "cpu"},
                                    {Placement::Float32, "float32"}};

}  // namespace

std::string_view placementName(Placement placement) noexcept {
  for (const PlacementName& row : kNames)
    if (row.placement == placement) return row.name;
  return "";
}

Result<Placement> parsePlacement(std::string_view text) {
  for (const PlacementName& row : kNames)
    if (row.name == text) return row.placement;
  return makeError(ErrorKind::InvalidArgument, "--placement",
                   fmt::format("'{}' is none of integer, double-float, cpu, float32", text));
}

}  // namespace terrane

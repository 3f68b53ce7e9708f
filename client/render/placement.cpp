#include "client/render/placement.h"

#include <fmt/format.h>

#include <cmath>

#include "client/render/tile_renderer.h"

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

CameraOnLattice cameraOnLattice(const glm::dvec3& cameraBody, int stepExponent) noexcept {
  const double stepsPerMeter = stepMeters(-stepExponent);  // a power of two: the product is exact
  CameraOnLattice camera;
  for (int axis = 0; axis < 3; ++axis) {
    const double inSteps = cameraBody[axis] * stepsPerMeter;
    const double whole = std::floor(inSteps);
    camera.steps[axis] = static_cast<std::int64_t>(whole);
    camera.rest[axis] = static_cast<float>(inSteps - whole);
  }
  return camera;
}

std::optional<glm::ivec3> originMinusCamera(const LatticePoint& origin, const LatticePoint& cameraSteps) noexcept {
  glm::ivec3 difference(0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t exact = origin[axis] - cameraSteps[axis];
    if (exact > kMaxPlacedSteps || exact < -kMaxPlacedSteps) return std::nullopt;
    difference[axis] = static_cast<std::int32_t>(exact);
  }
  return difference;
}

FloatPairVec splitToFloats(const glm::dvec3& value) noexcept {
  FloatPairVec pair;
  for (int axis = 0; axis < 3; ++axis) {
    pair.high[axis] = static_cast<float>(value[axis]);
    pair.low[axis] = static_cast<float>(value[axis] - static_cast<double>(pair.high[axis]));
  }
  return pair;
}

}  // namespace terrane

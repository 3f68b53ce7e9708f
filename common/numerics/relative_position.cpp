#include "common/numerics/relative_position.h"

#include <algorithm>
#include <cmath>

namespace terrane {

CameraOnLattice cameraOnLattice(const glm::dvec3& cameraBody, double stepMeters) noexcept {
  CameraOnLattice camera;
  for (int axis = 0; axis < 3; ++axis) {
    const double exact = cameraBody[axis] / stepMeters;  // by a power of two
    const double inSteps = std::isnan(exact) ? 0 : std::clamp(exact, -0x1p62, 0x1p62);
    const double whole = std::floor(inSteps);
    camera.steps[axis] = static_cast<std::int64_t>(whole);
    camera.rest[axis] = static_cast<float>(inSteps - whole);
  }
  return camera;
}

std::optional<glm::ivec3> originMinusCamera(const glm::i64vec3& origin, const glm::i64vec3& cameraSteps) noexcept {
  glm::ivec3 difference(0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t exact = origin[axis] - cameraSteps[axis];
    if (exact > kMaxPlacedSteps || exact < -kMaxPlacedSteps) return std::nullopt;
    difference[axis] = static_cast<std::int32_t>(exact);
  }
  return difference;
}

}  // namespace terrane

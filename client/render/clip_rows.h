#pragma once
// From positions relative to the camera to the screen and back; body axes, metres. Thread-safe.

#include <glm/mat3x3.hpp>

#include "common/view/camera.h"

namespace terrane {

/// Rows x, y and w of projection * rotation, as clipPosition in client/shaders/projection.glsl takes them; the z row is
/// the constant near plane.
glm::dmat3 clipRows(const Camera& camera) noexcept;

/// The inverse: (x, y, 1), the screen being -1..1, gives the point one metre ahead of the camera that lies there.
glm::dmat3 screenRays(const Camera& camera) noexcept;

}  // namespace terrane

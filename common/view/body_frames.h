#pragma once
// One camera seen from several bodies of a scene. Body frames and the scene's have parallel axes, so that only the
// position differs. Pure functions, thread-safe.

#include <glm/vec3.hpp>

#include "common/view/camera.h"

namespace terrane {

/// The same camera in the frame of another body: `from` and `to` are the centres in the scene's frame, metres. Along
/// each axis the position is off by at most 2^-53 (|from - to| + |result|), by a rounding of each of its two sums:
/// wherever in the scene the two bodies lie, only how far they are apart counts. That is no more than 2^-52 of the
/// camera's distances from both centres together, nanometres between planets; the altitude is off by that over all axes
/// and by three roundings, 2^-51 of the distance to the centre. Equal centres give the position unchanged.
Camera cameraOverOther(const Camera& camera, const glm::dvec3& fromScene, const glm::dvec3& toScene,
                       double toRadiusMeters) noexcept;

/// How many pixels across a sphere around the camera's body appears, seen from outside; infinite from within.
double diameterPixels(const Camera& camera, double radiusMeters) noexcept;

}  // namespace terrane

#include "common/view/body_frames.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace terrane {

Camera cameraOverOther(const Camera& camera, const glm::dvec3& fromScene, const glm::dvec3& toScene,
                       double toRadiusMeters) noexcept {
  Camera over = camera;
  over.positionBody = camera.positionBody + (fromScene - toScene);
  over.altitudeMeters = glm::length(over.positionBody) - toRadiusMeters;
  return over;
}

double diameterPixels(const Camera& camera, double radiusMeters) noexcept {
  const double distance = glm::length(camera.positionBody);
  if (!(distance > radiusMeters)) return std::numeric_limits<double>::infinity();
  const double tangent = std::sqrt((distance - radiusMeters) * (distance + radiusMeters));
  return 2 * radiusMeters / tangent * pixelsPerRadian(camera);
}

}  // namespace terrane

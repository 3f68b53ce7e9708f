#include "common/view/level_of_detail.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace terrane {

double distanceMeters(const OrientedBox& box, const glm::dvec3& pointBody) noexcept {
  const glm::dvec3 toPoint = pointBody - box.center;
  double squared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double halfLength = glm::length(box.halfAxes[i]);
    // A flat box's third direction is the normal of the other two.
    const glm::dvec3 along =
        halfLength > 0 ? box.halfAxes[i] : glm::cross(box.halfAxes[(i + 1) % 3], box.halfAxes[(i + 2) % 3]);
    const double alongLength = glm::length(along);
    if (!(alongLength > 0)) continue;
    const double excess = std::abs(glm::dot(toPoint, along)) / alongLength - halfLength;
    if (excess > 0) squared += excess * excess;
  }
  return std::sqrt(squared);
}

double screenSpaceErrorPixels(double geometricErrorMeters, const OrientedBox& box, const Camera& camera) noexcept {
  const double distance = distanceMeters(box, camera.positionBody);
  if (!(distance > 0)) return std::numeric_limits<double>::infinity();
  return geometricErrorMeters * pixelsPerRadian(camera) / distance;
}

}  // namespace terrane

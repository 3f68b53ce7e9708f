#include "common/view/level_of_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace terrane {
namespace {

/// From a box' nearest point to a point outside, along the box' axes; half the box' size along them.
struct Nearest {
  std::array<double, 3> excess{}, half{};

  double distance() const noexcept {
    return std::sqrt(excess[0] * excess[0] + excess[1] * excess[1] + excess[2] * excess[2]);
  }
  double foreshortening(double distanceMeters) const noexcept {
    const double top = half[0] * half[1];
    const double projected = half[1] * half[2] * excess[0] + half[2] * half[0] * excess[1] + top * excess[2];
    // Beyond about 1e154 m the distance is infinite, and the shares below may be too.
    if (!(distanceMeters > 0) || !(top > 0) || std::isinf(distanceMeters)) return 1.0;
    return std::clamp(std::sqrt(projected / (top * distanceMeters)), kLeastForeshortening, 1.0);
  }
};

Nearest nearestPoint(const OrientedBox& box, const glm::dvec3& pointBody) noexcept {
  const glm::dvec3 toPoint = pointBody - box.center;
  Nearest nearest;
  for (std::size_t i = 0; i < 3; ++i) {
    nearest.half[i] = glm::length(box.halfAxes[i]);
    // A flat box's third direction is the normal of the other two.
    const glm::dvec3 along =
        nearest.half[i] > 0 ? box.halfAxes[i] : glm::cross(box.halfAxes[(i + 1) % 3], box.halfAxes[(i + 2) % 3]);
    const double alongLength = glm::length(along);
    if (!(alongLength > 0)) continue;
    nearest.excess[i] = std::max(0.0, std::abs(glm::dot(toPoint, along)) / alongLength - nearest.half[i]);
  }
  return nearest;
}

}  // namespace

double distanceMeters(const OrientedBox& box, const glm::dvec3& pointBody) noexcept {
  return nearestPoint(box, pointBody).distance();
}

double foreshortening(const OrientedBox& box, const glm::dvec3& pointBody) noexcept {
  const Nearest nearest = nearestPoint(box, pointBody);
  return nearest.foreshortening(nearest.distance());
}

double screenSpaceErrorPixels(double geometricErrorMeters, const OrientedBox& box, const Camera& camera) noexcept {
  const Nearest nearest = nearestPoint(box, camera.positionBody);
  const double distance = nearest.distance();
  if (!(distance > 0)) return std::numeric_limits<double>::infinity();
  return geometricErrorMeters * pixelsPerRadian(camera) / distance * nearest.foreshortening(distance);
}

}  // namespace terrane

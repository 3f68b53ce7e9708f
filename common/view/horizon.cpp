#include "common/view/horizon.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace terrane {

double horizonDistanceMeters(double radiusMeters, double heightMeters) noexcept {
  if (!(heightMeters > 0)) return 0;
  return std::sqrt(heightMeters * (2 * radiusMeters + heightMeters));
}

Horizon::Horizon(const glm::dvec3& cameraBody, double radiusMeters, double altitudeMeters,
                 double occluderRadiusMeters) noexcept
    : cameraBody_(cameraBody) {
  const double height = altitudeMeters + (radiusMeters - occluderRadiusMeters);
  if (!(height > 0) || !(occluderRadiusMeters > 0)) return;
  inverseRadius_ = 1.0 / occluderRadiusMeters;
  cameraScaled_ = cameraBody * inverseRadius_;
  const double heightScaled = height * inverseRadius_;
  horizonDistanceSquared_ = heightScaled * (2 + heightScaled);
  active_ = std::isfinite(horizonDistanceSquared_) && std::isfinite(glm::dot(cameraScaled_, cameraScaled_));
}

bool Horizon::hides(const glm::dvec3& pointBody) const noexcept {
  if (!active_) return false;
  // Subtracted in metres first: near the camera that is exact, and the scaling then only rounds once.
  const glm::dvec3 toPoint = (pointBody - cameraBody_) * inverseRadius_;
  const double inward = -glm::dot(toPoint, cameraScaled_);
  // Behind the plane of the horizon circle, and inside the cone that touches the sphere there. A NaN fails either
  // comparison.
  return inward > horizonDistanceSquared_ && inward * inward > horizonDistanceSquared_ * glm::dot(toPoint, toPoint);
}

}  // namespace terrane

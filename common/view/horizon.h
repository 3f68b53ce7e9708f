#pragma once
// Horizon culling against a sphere inside the body (the lowest surface), in the scaled space where that sphere has
// radius 1 (Ring 2013, "Horizon culling"). The altitude over the sphere is kept as its own quantity, so that 1 mm above
// ground still has a horizon: sqrt(h (2 r + h)), not sqrt(d^2 - r^2). Thread-safe.

#include <glm/vec3.hpp>

namespace terrane {

/// Distance to the horizon from h metres above a sphere of radius r; 0 at or below it. Relative error <= 4 u.
double horizonDistanceMeters(double radiusMeters, double heightMeters) noexcept;

class Horizon {
 public:
  /// altitudeMeters: above the reference sphere radiusMeters; the occluder sphere has radius occluderRadiusMeters.
  Horizon(const glm::dvec3& cameraBody, double radiusMeters, double altitudeMeters,
          double occluderRadiusMeters) noexcept;

  /// True when the sphere hides the point. Always false when the camera is at or inside the sphere, or the point is not
  /// finite.
  bool hides(const glm::dvec3& pointBody) const noexcept;
  bool active() const noexcept { return active_; }

 private:
  glm::dvec3 cameraBody_;
  glm::dvec3 cameraScaled_{0.0};
  double inverseRadius_ = 0;
  double horizonDistanceSquared_ = 0;  ///< scaled
  bool active_ = false;
};

}  // namespace terrane

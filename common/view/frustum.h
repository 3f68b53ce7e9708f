#pragma once
// The view frustum as five planes through (or in front of) the camera, and an almost exact test of a tile's hull
// against it. All arithmetic is relative to the camera, in double. Thread-safe.

#include <array>
#include <glm/vec3.hpp>

#include "common/tiling/tile_bounds.h"
#include "common/view/camera.h"

namespace terrane {

class Frustum {
 public:
  explicit Frustum(const Camera& camera) noexcept;

  /// False only if no point of the hull is inside the frustum (never a false negative); separating axes over both
  /// bodies' faces and edges, so that false positives are rare.
  bool mayContain(const std::array<glm::dvec3, 8>& hullBody) const noexcept;
  bool contains(const glm::dvec3& pointBody) const noexcept;
  /// All of it. A sphere that touches a plane within rounding counts as one or the other.
  bool contains(const Sphere& sphereBody) const noexcept;

 private:
  using Hull = std::array<glm::dvec3, 8>;
  bool separated(const Hull& hull, const glm::dvec3& axis, double axisScale, double extent) const noexcept;

  glm::dvec3 cameraBody_;
  double cameraMagnitude_;
  /// Inward normals of left, right, bottom, top, near; a point p (camera-relative) is inside when dot(n, p) >= offset.
  std::array<glm::dvec3, 5> normals_;
  std::array<double, 5> offsets_;
  std::array<glm::dvec3, 4> edgeDirections_;  ///< the frustum's corner rays, unit
  std::array<glm::dvec3, 4> nearCorners_;     ///< camera-relative
  glm::dvec3 right_, up_;
};

}  // namespace terrane

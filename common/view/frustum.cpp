#include "common/view/frustum.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace terrane {
namespace {

/// Rounding of a dot product along an axis, per unit of (axis length x distance); 45 u, where 4 u is what the
/// arithmetic here can lose and the rest allows for the rounding of hull and camera themselves.
constexpr double kRounding = 1e-14;
/// A corner ray counts as parallel to an axis below this share of the axis' scale: an axis made as a cross product with
/// that ray is perpendicular to it only up to rounding.
constexpr double kParallel = 1e-15;

double sumOfMagnitudes(const glm::dvec3& v) noexcept { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Triangles that cover the hull's faces, hull corner indices. A side face lies in a plane and needs one; the four
/// corners of a cap need not, and both diagonals' triangles are tried, whichever of them the hull has.
constexpr std::array<std::array<int, 3>, 12> kFaces{{{0, 1, 4},
                                                     {1, 3, 5},
                                                     {3, 2, 7},
                                                     {2, 0, 6},
                                                     {4, 5, 7},
                                                     {4, 7, 6},
                                                     {4, 5, 6},
                                                     {5, 7, 6},
                                                     {0, 1, 3},
                                                     {0, 3, 2},
                                                     {0, 1, 2},
                                                     {1, 3, 2}}};
constexpr std::array<std::array<int, 2>, 16> kEdges{{{0, 1},
                                                     {1, 3},
                                                     {3, 2},
                                                     {2, 0},
                                                     {4, 5},
                                                     {5, 7},
                                                     {7, 6},
                                                     {6, 4},
                                                     {0, 4},
                                                     {1, 5},
                                                     {2, 6},
                                                     {3, 7},
                                                     {4, 7},
                                                     {5, 6},
                                                     {0, 3},
                                                     {1, 2}}};

}  // namespace

Frustum::Frustum(const Camera& camera) noexcept
    : cameraBody_(camera.positionBody),
      cameraMagnitude_(sumOfMagnitudes(camera.positionBody)),
      right_(camera.right),
      up_(camera.up) {
  const glm::dvec3 forward = -camera.backward;
  const double halfHeight = std::tan(0.5 * camera.verticalFieldOfView);
  const double halfWidth =
      halfHeight * static_cast<double>(camera.widthPixels) / static_cast<double>(camera.heightPixels);
  normals_ = {glm::normalize(right_ + halfWidth * forward), glm::normalize(halfWidth * forward - right_),
              glm::normalize(up_ + halfHeight * forward), glm::normalize(halfHeight * forward - up_), forward};
  offsets_ = {0, 0, 0, 0, camera.nearMeters};
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = (i & 1u) != 0 ? halfWidth : -halfWidth, y = (i & 2u) != 0 ? halfHeight : -halfHeight;
    const glm::dvec3 ray = forward + x * right_ + y * up_;
    edgeDirections_[i] = glm::normalize(ray);
    nearCorners_[i] = ray * camera.nearMeters;
  }
}

bool Frustum::contains(const glm::dvec3& pointBody) const noexcept {
  const glm::dvec3 p = pointBody - cameraBody_;
  for (std::size_t i = 0; i < normals_.size(); ++i)
    if (!(glm::dot(normals_[i], p) >= offsets_[i])) return false;
  return true;
}

bool Frustum::contains(const Sphere& sphereBody) const noexcept {
  const glm::dvec3 p = sphereBody.center - cameraBody_;
  for (std::size_t i = 0; i < normals_.size(); ++i)
    if (!(glm::dot(normals_[i], p) >= offsets_[i] + sphereBody.radiusMeters)) return false;
  return true;
}

/// True when the axis proves hull (camera-relative) and frustum apart. The frustum is its near corners plus all sums of
/// its corner rays: along an axis it is bounded on one side exactly when no ray points there. axisScale: what the axis'
/// rounding is relative to.
bool Frustum::separated(const Hull& hull, const glm::dvec3& axis, double axisScale, double extent) const noexcept {
  double lowestRay = glm::dot(axis, edgeDirections_[0]), highestRay = lowestRay;
  for (std::size_t i = 1; i < 4; ++i) {
    const double along = glm::dot(axis, edgeDirections_[i]);
    lowestRay = std::min(lowestRay, along);
    highestRay = std::max(highestRay, along);
  }
  const double parallel = kParallel * axisScale;
  const bool boundedBelow = lowestRay >= -parallel, boundedAbove = highestRay <= parallel;
  if (!boundedBelow && !boundedAbove) return false;

  double hullLow = glm::dot(axis, hull[0]), hullHigh = hullLow;
  for (std::size_t i = 1; i < hull.size(); ++i) {
    const double along = glm::dot(axis, hull[i]);
    hullLow = std::min(hullLow, along);
    hullHigh = std::max(hullHigh, along);
  }
  double nearLow = glm::dot(axis, nearCorners_[0]), nearHigh = nearLow;
  for (std::size_t i = 1; i < 4; ++i) {
    const double along = glm::dot(axis, nearCorners_[i]);
    nearLow = std::min(nearLow, along);
    nearHigh = std::max(nearHigh, along);
  }
  const double margin = kRounding * axisScale * extent;
  return (boundedBelow && hullHigh < nearLow - margin) || (boundedAbove && hullLow > nearHigh + margin);
}

bool Frustum::mayContain(const Hull& hullBody) const noexcept {
  Hull hull;
  double extent = cameraMagnitude_;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    hull[i] = hullBody[i] - cameraBody_;
    extent = std::max(extent, sumOfMagnitudes(hull[i]));
  }
  extent += sumOfMagnitudes(nearCorners_[0]);

  // The frustum's own planes first: they decide almost all cases. A corner clearly inside all of them ends the search.
  unsigned insideAll = 0xFF;
  for (std::size_t plane = 0; plane < normals_.size(); ++plane) {
    unsigned inside = 0;
    bool allOutside = true;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const double above = glm::dot(normals_[plane], hull[i]) - offsets_[plane];
      if (!(above < -kRounding * extent)) allOutside = false;
      if (above >= 0) inside |= 1u << i;
    }
    if (allOutside) return false;
    insideAll &= inside;
  }
  if (insideAll != 0) return true;

  for (const auto& [a, b, c] : kFaces) {
    const glm::dvec3 axis = glm::cross(hull[b] - hull[a], hull[c] - hull[a]);
    if (separated(hull, axis, sumOfMagnitudes(axis), extent)) return false;
  }
  for (const auto& [a, b] : kEdges) {
    const glm::dvec3 edge = hull[b] - hull[a];
    const double scale = sumOfMagnitudes(edge);
    if (separated(hull, glm::cross(edge, right_), scale, extent)) return false;
    if (separated(hull, glm::cross(edge, up_), scale, extent)) return false;
    for (const glm::dvec3& ray : edgeDirections_)
      if (separated(hull, glm::cross(edge, ray), scale, extent)) return false;
  }
  return true;
}

}  // namespace terrane

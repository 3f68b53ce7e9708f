#include "server/build/edge_planes.h"

#include <cmath>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"

namespace terrane {
namespace {

glm::dvec3 scaledToLength(const glm::dvec3& n, double length) noexcept {
  return n * (length / std::sqrt((n.x * n.x + n.y * n.y) + n.z * n.z));
}

std::array<glm::dvec3, kMostEdges> cubeNormals(const FacePath& path) noexcept {
  const FaceAxes& axes = cubeFaceAxes(path.face());
  const auto tangent = [&](std::uint32_t line) { return tanQuarterPi(std::ldexp(line, 1 - path.level()) - 1.0); };
  const auto normal = [&](const glm::dvec3& along, double t, double sign) {
    return scaledToLength(along - axes.normal * t, sign);
  };
  return {normal(axes.v, tangent(path.row()), -1.0), normal(axes.u, tangent(path.column() + 1), 1.0),
          normal(axes.v, tangent(path.row() + 1), 1.0), normal(axes.u, tangent(path.column()), -1.0)};
}

/// From the difference of two corners, which is exact but at the coarsest levels: their own product would lose the
/// digits that they share.
std::array<glm::dvec3, kMostEdges> icoNormals(const FacePath& path) noexcept {
  const auto corners = icoCornerDirections(kIcoMap, path);
  std::array<glm::dvec3, kMostEdges> normals{};
  for (std::size_t edge = 0; edge < corners.size(); ++edge) {
    const glm::dvec3& from = corners[(edge + 1) % corners.size()];
    const glm::dvec3 along = corners[(edge + 2) % corners.size()] - from;
    normals[edge] = scaledToLength(
        {along.y * from.z - along.z * from.y, along.z * from.x - along.x * from.z, along.x * from.y - along.y * from.x},
        1.0);
  }
  return normals;
}

}  // namespace

EdgeNormals::EdgeNormals(const FacePath& path) noexcept
    : normals_(path.scheme() == Scheme::Cube ? cubeNormals(path) : icoNormals(path)),
      count_(static_cast<std::size_t>(edgeCount(path.scheme()))) {}

glm::dvec3 EdgeNormals::lean(std::size_t edge, std::size_t k, std::size_t cells) const noexcept {
  if (k != 0 && k != cells) return normals_[edge];
  const glm::dvec3& other = normals_[(edge + (k == 0 ? count_ - 1 : 1)) % count_];
  // In this order for both edges, so that they round alike.
  const glm::dvec3 &first = k == 0 ? other : normals_[edge], &second = k == 0 ? normals_[edge] : other;
  const double cosine = (first.x * second.x + first.y * second.y) + first.z * second.z;
  return (first + second) * (1.0 / (1.0 + cosine));
}

}  // namespace terrane

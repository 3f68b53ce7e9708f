#pragma once
// The maps of ico_sphere.h as they are defined, in arithmetic of 60 digits: what the doubles are compared with.

#include <array>
#include <map>

#include "common/tiling/ico_sphere.h"
#include "tests/support/high_precision.h"
#include "tests/support/ico_points.h"

namespace terrane::test {

using PreciseVector = std::array<HighPrecision, 3>;

inline HighPrecision dot(const PreciseVector& a, const PreciseVector& b) {
  return HighPrecision(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}
inline PreciseVector cross(const PreciseVector& a, const PreciseVector& b) {
  return {HighPrecision(a[1] * b[2] - a[2] * b[1]), HighPrecision(a[2] * b[0] - a[0] * b[2]),
          HighPrecision(a[0] * b[1] - a[1] * b[0])};
}
inline PreciseVector normalised(const PreciseVector& p) {
  const HighPrecision length = sqrt(dot(p, p));
  return {HighPrecision(p[0] / length), HighPrecision(p[1] / length), HighPrecision(p[2] / length)};
}
inline PreciseVector sum(const PreciseVector& a, const PreciseVector& b) {
  return {HighPrecision(a[0] + b[0]), HighPrecision(a[1] + b[1]), HighPrecision(a[2] + b[2])};
}
inline PreciseVector precise(const glm::dvec3& p) {
  return {HighPrecision(p.x), HighPrecision(p.y), HighPrecision(p.z)};
}

/// The vertex with the same signs as the doubles, from the golden ratio.
inline PreciseVector preciseVertex(int vertex) {
  const HighPrecision golden = (1 + sqrt(HighPrecision(5))) / 2, a = 1 / sqrt(HighPrecision(1 + golden * golden));
  const glm::dvec3 rounded = icosahedronVertex(vertex);
  PreciseVector out;
  for (int axis = 0; axis < 3; ++axis) {
    const double c = rounded[axis], size = c < 0 ? -c : c;
    const HighPrecision exact = size == 0 ? HighPrecision(0) : size < 0.7 ? a : HighPrecision(golden * a);
    out[static_cast<std::size_t>(axis)] = c < 0 ? HighPrecision(-exact) : exact;
  }
  return out;
}

inline PreciseVector preciseGnomonic(int face, const FaceWeights& weights) {
  PreciseVector flat{0, 0, 0};
  for (int k = 0; k < kTriangleCorners; ++k) {
    const PreciseVector corner = preciseVertex(icosahedronCorners(face)[static_cast<std::size_t>(k)]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      flat[axis] = HighPrecision(flat[axis] + HighPrecision(static_cast<double>(weights[k])) * corner[axis]);
  }
  return normalised(flat);
}

/// By the rule itself: a vertex is the normalised middle of the one edge of the grid of half as many cells on whose
/// middle it lies; no triangle is walked. Remembers what it has worked out of a face.
class PreciseBisection {
 public:
  explicit PreciseBisection(int face) : face_(face) {}

  PreciseVector at(int gridLevel, FaceWeights weights) {
    const auto odd = [&](int k) { return (weights[k] & 1) != 0; };
    for (; gridLevel > 0 && !odd(0) && !odd(1) && !odd(2); --gridLevel) weights /= std::int64_t{2};
    if (gridLevel == 0) {
      const auto& corners = icosahedronCorners(face_);
      return preciseVertex(corners[weights.x == 1 ? 0 : weights.y == 1 ? 1 : 2]);
    }
    const std::array<std::int64_t, 4> key{gridLevel, weights.x, weights.y, weights.z};
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    const int even = !odd(0) ? 0 : !odd(1) ? 1 : 2;
    FaceWeights along(0);
    along[(even + 1) % 3] = 1;
    along[(even + 2) % 3] = -1;
    const PreciseVector middle = normalised(sum(at(gridLevel, weights + along), at(gridLevel, weights - along)));
    return known_[key] = middle;
  }

 private:
  int face_;
  std::map<std::array<std::int64_t, 4>, PreciseVector> known_;
};

inline PreciseVector preciseDirection(IcoMap map, int face, int gridLevel, const FaceWeights& weights) {
  if (map == IcoMap::Gnomonic) return preciseGnomonic(face, weights);
  return PreciseBisection(face).at(gridLevel, weights);
}

}  // namespace terrane::test

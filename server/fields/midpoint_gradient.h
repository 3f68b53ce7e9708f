#pragma once
// The gradient of the mesh around a vertex: that of its triangles (of its neighbours' polygon, on the cube), by their
// areas. With neighbours p_k counter-clockwise around p, their heights h_k and h,
//   sum_k (h_k - h) (p_k+1 - p_k-1) x p / (R sum_k p . (p_k - p) x (p_k+1 - p)),
// exact where the height is linear. Summed from the neighbour with the least direction on: all tiles that have the
// vertex round alike, to the last bit of a double (midpoint_field_test).

#include <array>
#include <tuple>

#include "server/fields/midpoint_subdivision.h"

namespace terrane::midpoint {

inline bool before(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// The vertices beside one, each once, counter-clockwise from the one with the least direction on. Before the first
/// stands the last, and after the last the first.
template <class Tiling>
class Neighbours {
 public:
  Neighbours(const Places& places, int i, int j) noexcept {
    std::array<const Vertex*, Tiling::kNeighbours> around{};
    std::size_t least = 0;
    for (const GridVertex& step : Tiling::kBeside) {
      const Vertex* vertex = &places.at(i + step.i, j + step.j);
      // Beside a corner of the solid two places, next to each other, are one vertex.
      if (count_ > 0 && around[count_ - 1]->direction == vertex->direction) continue;
      if (count_ > 0 && before(vertex->direction, around[least]->direction)) least = count_;
      around[count_++] = vertex;
    }
    if (around[count_ - 1]->direction == around[0]->direction) --count_;
    for (std::size_t k = 0; k < count_ + 2; ++k) {
      const std::size_t at = least + k + count_ - 1;
      ordered_[k] = around[at >= 2 * count_ ? at - 2 * count_ : at >= count_ ? at - count_ : at];
    }
  }
  std::size_t count() const noexcept { return count_; }
  /// 0 .. count + 1.
  const Vertex& operator[](std::size_t k) const noexcept { return *ordered_[k]; }

 private:
  std::array<const Vertex*, Tiling::kNeighbours + 2> ordered_{};
  std::size_t count_ = 0;
};

/// Along the sphere; metres per metre.
template <class Tiling>
glm::dvec3 gradientAt(const Places& places, int i, int j, double radiusMeters) noexcept {
  const Vertex& here = places.at(i, j);
  const Neighbours<Tiling> beside(places, i, j);
  glm::dvec3 turned(0.0), area(0.0);
  for (std::size_t k = 1; k <= beside.count(); ++k) {
    const Vertex &last = beside[k - 1], &now = beside[k], &next = beside[k + 1];
    turned += (next.direction - last.direction) * (now.heightMeters - here.heightMeters);
    area += cross(now.direction - here.direction, next.direction - here.direction);
  }
  return cross(turned, here.direction) / (radiusMeters * dot(area, here.direction));
}

}  // namespace terrane::midpoint

#pragma once
// The great-circle planes through a tile's edges. Body frame. Deterministic: + - x / sqrt alone. Thread-safe.

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "common/tiling/face_path.h"
#include "common/tiling/tile_neighbours.h"

namespace terrane {

/// Unit, outwards, in the order of the skirts (tile_topology.h).
class EdgeNormals {
 public:
  explicit EdgeNormals(const FacePath& path) noexcept;

  /// How far skirt vertex k of 0 .. cells leans outwards, in units of the flare: along its edge's normal, or at the
  /// ends along the mitre with the next edge's, as far as takes it out of both planes by one. Both edges give the same
  /// bits there.
  glm::dvec3 lean(std::size_t edge, std::size_t k, std::size_t cells) const noexcept;

 private:
  std::array<glm::dvec3, kMostEdges> normals_{};
  std::size_t count_ = 0;
};

}  // namespace terrane

#pragma once
// A tile as it is to be drawn: between its own surface and its parent's. 0 is the tile's own, 1 the parent's; what is
// in between moves every vertex of the grid on a straight line towards the point of the parent's mesh that it lies on
// when fully morphed. Interior, edges and corners have values of their own, so that two tiles agree on what they share.
// Plain values.

#include <array>
#include <cstdint>

#include "common/tiling/face_path.h"

namespace terrane {

struct TileMorph {
  float own = 0;                          ///< of all vertices that are on no edge
  std::array<float, kSideCount> sides{};  ///< by Side: edges without their ends, and corners
  /// Bit e is set where edge e is the parent's, all the way: the odd vertices of that edge are then not drawn. A
  /// coarser tile beyond has none, and an equal one leaves them out too.
  std::uint8_t coarserEdges = 0;

  bool operator==(const TileMorph&) const = default;
};

struct DrawnTile {
  FacePath path;
  TileMorph morph;

  bool operator==(const DrawnTile&) const = default;
};

}  // namespace terrane

#pragma once
// A tile as it is to be drawn: between its own surface and its parent's. 0 is the tile's own, 1 the parent's; what is
// in between moves every vertex of the grid on a straight line towards the point of the parent's mesh that it lies on
// when fully morphed. Interior, edges and corners have values of their own, so that two tiles agree on what they share.
// Plain values.

#include <array>
#include <cstdint>

#include "common/tiling/face_path.h"
#include "common/tiling/tile_grid.h"
#include "common/tiling/tile_neighbours.h"

namespace terrane {

struct TileMorph {
  float own = 0;  ///< of all vertices that are on no edge
  /// Edges without their ends, by number, and from kMostEdges on corners (tile_neighbours.h): for the cube, by Side.
  std::array<float, 2 * kMostEdges> sides{};
  /// Bit e is set where edge e is the parent's, all the way: the odd vertices of that edge are then not drawn. A
  /// coarser tile beyond has none, and an equal one leaves them out too.
  std::uint8_t coarserEdges = 0;

  bool operator==(const TileMorph&) const = default;
};

/// A tile's morph values by the borders that a vertex is on (tile_grid.h); sums that no vertex has hold 0.
using MorphByBorders = std::array<float, kBorderSets>;
inline MorphByBorders morphByBorders(const TileGrid& grid, const TileMorph& morph) noexcept {
  MorphByBorders values{};
  values[0] = morph.own;
  for (int k = 0; k < edgeCount(grid.scheme); ++k) {
    values[grid.borderOf(k)] = morph.sides[static_cast<std::size_t>(k)];
    values[grid.bordersOfCorner(k)] = morph.sides[static_cast<std::size_t>(kMostEdges + k)];
  }
  return values;
}

struct DrawnTile {
  FacePath path;
  TileMorph morph;

  bool operator==(const DrawnTile&) const = default;
};

}  // namespace terrane

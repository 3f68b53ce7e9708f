#pragma once
// A tile as it is to be drawn: between its own surface and its parent's. 0 is the tile's own, 1 the parent's; what is
// in between moves every vertex of the grid on a straight line towards the point of the parent's mesh that it lies on
// when fully morphed. Interior, edges and corners have values of their own, so that two tiles agree on what they share.
// Plain values.

#include <array>
#include <cstdint>

#include "common/tiling/face_path.h"
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

/// A tile's morph values by place: rows VMin, between, VMax of columns UMin, between, UMax.
inline std::array<float, 9> morphByPlace(const TileMorph& morph) noexcept {
  const auto of = [&](Side side) { return morph.sides[static_cast<std::size_t>(side)]; };
  return {of(Side::UMinVMin), of(Side::VMin),     of(Side::UMaxVMin), of(Side::UMin),    morph.own,
          of(Side::UMax),     of(Side::UMinVMax), of(Side::VMax),     of(Side::UMaxVMax)};
}
/// Of vertex (i, j) of a grid with so many vertices in a row.
inline float morphAt(const std::array<float, 9>& byPlace, int side, int i, int j) noexcept {
  const auto place = [side](int at) { return at == 0 ? 0u : at == side - 1 ? 2u : 1u; };
  return byPlace[3 * place(j) + place(i)];
}

struct DrawnTile {
  FacePath path;
  TileMorph morph;

  bool operator==(const DrawnTile&) const = default;
};

}  // namespace terrane

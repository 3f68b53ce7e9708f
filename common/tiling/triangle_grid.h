#pragma once
// The triangular grid of a tile: a triangle whose edges have `cells` cells, a power of two up to 2^15, and so
// (cells + 1) (cells + 2) / 2 vertices in rows parallel to the edge between corners 0 and 1. Integers; thread-safe.

#include <array>

namespace terrane {

/// i cells towards corner 1 and j cells towards corner 2 from corner 0; 0 <= i, j and i + j <= cells.
struct GridVertex {
  int i = 0, j = 0;
  bool operator==(const GridVertex&) const = default;
};

constexpr int triangleGridSize(int cells) noexcept { return (cells + 1) * (cells + 2) / 2; }

/// Row by row, the longest (j = 0) first, i upwards.
constexpr int triangleGridIndex(int cells, const GridVertex& vertex) noexcept {
  return vertex.j * (2 * cells + 3 - vertex.j) / 2 + vertex.i;
}

/// The k-th vertex along edge 0, 1 or 2, which runs from corner edge + 1 to corner edge + 2 (mod 3); 0 <= k <= cells.
/// The tile beyond has it as its (cells - k)-th.
constexpr GridVertex edgeVertex(int cells, int edge, int k) noexcept {
  if (edge == 0) return {cells - k, k};
  return edge == 1 ? GridVertex{0, cells - k} : GridVertex{k, 0};
}

/// The digit of a triangle's child in the middle, which is turned round.
inline constexpr int kCentreChild = 3;

/// The two vertices of the parent's grid between which a vertex of its child `digit` lies: the ends of an edge of the
/// parent's grid in whose middle it is, or twice the vertex that it is. A child's grid splits each triangle of the
/// parent's into four, so that no vertex lies inside one. Precondition: cells is even.
constexpr std::array<GridVertex, 2> parentGridVertices(int digit, int cells, const GridVertex& vertex) noexcept {
  // In half cells of the parent: corner children keep their corner, the centre child is turned round.
  GridVertex at = vertex;
  if (digit == 1) at.i += cells;
  if (digit == 2) at.j += cells;
  if (digit == kCentreChild) at = {cells - vertex.i, cells - vertex.j};
  // The parent's edge runs along i, along j, or, if both are odd, along their difference.
  const int stepI = vertex.i & 1;
  const int stepJ = (vertex.j & 1) != 0 && stepI != 0 ? -1 : vertex.j & 1;
  return {{{(at.i - stepI) / 2, (at.j - stepJ) / 2}, {(at.i + stepI) / 2, (at.j + stepJ) / 2}}};
}

}  // namespace terrane

#pragma once
// The vertices of a tile of either scheme as a grid of integers: which there are, in which order, how the triangles
// between them are made, what borders of the tile they are on, and where they lie on the parent's grid. A square has
// vertices (i, j) with 0 <= i, j <= cells; a triangle those with i + j <= cells (triangle_grid.h). Pure functions,
// thread-safe.

#include <array>
#include <compare>
#include <cstddef>

#include "common/tiling/face_path.h"
#include "common/tiling/tile_neighbours.h"
#include "common/tiling/triangle_grid.h"

namespace terrane {

/// The borders of a tile that a vertex is on, a bit each; 0 inside. A square has all four, a triangle the first three.
enum Border : unsigned {
  kFirstColumn = 1,  ///< i = 0
  kFirstRow = 2,     ///< j = 0
  kRowEnd = 4,       ///< the last vertex of its row
  kLastRow = 8,      ///< j = cells, of a square
};
/// One more than the greatest sum of bits that a vertex has: of a square's last corner.
inline constexpr unsigned kBorderSets = 13;

struct TileGrid {
  Scheme scheme = Scheme::Cube;
  int cells = 0;

  auto operator<=>(const TileGrid&) const = default;

  constexpr bool isSquare() const noexcept { return scheme == Scheme::Cube; }
  constexpr int vertexCount() const noexcept {
    return isSquare() ? (cells + 1) * (cells + 1) : triangleGridSize(cells);
  }
  /// The last column of a row.
  constexpr int rowEnd(int j) const noexcept { return isSquare() ? cells : cells - j; }
  constexpr bool has(const GridVertex& at) const noexcept {
    return at.i >= 0 && at.j >= 0 && at.j <= cells && at.i <= rowEnd(at.j);
  }
  /// As tile_mesh.h counts them. Precondition: has(at).
  constexpr int index(const GridVertex& at) const noexcept {
    return isSquare() ? at.j * (cells + 1) + at.i : triangleGridIndex(cells, at);
  }
  /// Precondition: has(at).
  constexpr unsigned borders(const GridVertex& at) const noexcept {
    return (at.i == 0 ? kFirstColumn : 0u) | (at.j == 0 ? kFirstRow : 0u) | (at.i == rowEnd(at.j) ? kRowEnd : 0u) |
           (isSquare() && at.j == cells ? kLastRow : 0u);
  }
  /// The border along an edge as tile_neighbours.h counts them.
  constexpr unsigned borderOf(int edge) const noexcept {
    constexpr std::array<unsigned, 4> kSquare{kFirstColumn, kRowEnd, kFirstRow, kLastRow};
    constexpr std::array<unsigned, 3> kTriangle{kRowEnd, kFirstColumn, kFirstRow};
    return isSquare() ? kSquare[static_cast<std::size_t>(edge)] : kTriangle[static_cast<std::size_t>(edge)];
  }
  /// The borders of a corner as tile_neighbours.h counts them.
  constexpr unsigned bordersOfCorner(int corner) const noexcept {
    constexpr std::array<unsigned, 4> kSquare{kFirstColumn | kFirstRow, kRowEnd | kFirstRow, kFirstColumn | kLastRow,
                                              kRowEnd | kLastRow};
    constexpr std::array<unsigned, 3> kTriangle{kFirstColumn | kFirstRow, kFirstRow | kRowEnd, kFirstColumn | kRowEnd};
    return isSquare() ? kSquare[static_cast<std::size_t>(corner)] : kTriangle[static_cast<std::size_t>(corner)];
  }

  /// The ends of the edge of the parent's mesh in whose middle a vertex of its child `digit` lies, or twice the vertex
  /// that it is; none lies inside a triangle. Preconditions: the parent has the same grid; cells is even.
  constexpr std::array<GridVertex, 2> parentVertices(int digit, const GridVertex& at) const noexcept {
    if (!isSquare()) return parentGridVertices(digit, cells, at);
    // A square's cells are cut from their first corner to their last.
    const int half = cells / 2;
    const GridVertex first{(at.i >> 1) + ((digit & 1) != 0 ? half : 0), (at.j >> 1) + ((digit & 2) != 0 ? half : 0)};
    return {first, {first.i + (at.i & 1), first.j + (at.j & 1)}};
  }

  /// Where a vertex of the surface is drawn beside coarser tiles: itself, or for an odd vertex of a coarser edge (a bit
  /// each) the even one before it, along a row or column of a square, counter-clockwise around a triangle. Taking
  /// always the one before keeps the triangles of both edges apart at a corner. Precondition: cells is even.
  constexpr GridVertex stitched(unsigned coarserEdges, const GridVertex& at) const noexcept {
    const unsigned on = borders(at);
    const auto isOn = [&](int edge) {
      return ((coarserEdges >> static_cast<unsigned>(edge)) & 1u) != 0 && (on & borderOf(edge)) != 0;
    };
    if (isSquare()) {
      const bool alongRow = isOn(static_cast<int>(Side::VMin)) || isOn(static_cast<int>(Side::VMax));
      const bool alongColumn = isOn(static_cast<int>(Side::UMin)) || isOn(static_cast<int>(Side::UMax));
      return {alongRow ? at.i & ~1 : at.i, alongColumn ? at.j & ~1 : at.j};
    }
    // An odd vertex is on one edge alone.
    if (isOn(0) && (at.j & 1) != 0) return {at.i + 1, at.j - 1};
    if (isOn(1) && (at.j & 1) != 0) return {0, at.j + 1};
    if (isOn(2) && (at.i & 1) != 0) return {at.i - 1, 0};
    return at;
  }

  /// Calls use(a, b, c) with the corners of each triangle of a cell, counter-clockwise from outside: two of a square's
  /// cell; of a triangle's the one that lies as the tile does and, unless the cell is its row's last, the one turned
  /// round. Precondition: the cell's first corner is (i, j), and has((i + 1, j)) and has((i, j + 1)).
  template <class Use>
  constexpr void eachTriangle(int i, int j, const Use& use) const {
    const GridVertex v00{i, j}, v10{i + 1, j}, v01{i, j + 1}, v11{i + 1, j + 1};
    if (isSquare()) {
      use(v00, v10, v11);
      use(v00, v11, v01);
    } else {
      use(v00, v10, v01);
      if (has(v11)) use(v10, v11, v01);
    }
  }
};

}  // namespace terrane

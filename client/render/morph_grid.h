#pragma once
// Where a tile's grid lies on its parent's, in integers. The parent's step is twice the tile's, and a square's cells
// are cut from corner 00 to 11, so that every vertex of the tile lies on a vertex of the parent's mesh or in the middle
// between two: what it moves to when fully morphed is exact. Pure functions, thread-safe; client/shaders/morph.glsl
// does the same.

#include <array>
#include <cstdint>
#include <glm/ext/vector_int2_sized.hpp>
#include <glm/ext/vector_int3_sized.hpp>
#include <optional>

#include "common/tiling/lattice.h"
#include "common/view/drawn_tile.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// Grid indices in the parent's mesh; equal where the vertex lies on one of the parent's.
struct ParentVertices {
  int first = 0, second = 0;
};

struct MorphGrid {
  TileGrid grid;                 ///< of both
  int digit = 0;                 ///< which of the parent's children the tile is
  glm::ivec3 parentMinusOwn{0};  ///< twice the parent's origin minus the tile's, in the tile's steps

  ParentVertices parentVertices(const GridVertex& at) const noexcept {
    const auto [first, second] = grid.parentVertices(digit, at);
    return {grid.index(first), grid.index(second)};
  }
  /// Where the tile's vertex (0, 0) lies, in half cells of the parent's grid, and which way its rows and columns go.
  glm::ivec2 firstInHalfCells() const noexcept;
  int direction() const noexcept { return !grid.isSquare() && digit == kCentreChild ? -1 : 1; }
};

/// Empty where the two do not fit on one another: other cells, an odd number of them, other steps, origins far apart.
/// Precondition: tile.path is a child of parent.path.
std::optional<MorphGrid> morphGrid(const TileMetadata& tile, const TileMetadata& parent) noexcept;

}  // namespace terrane

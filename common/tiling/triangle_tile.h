#pragma once
// A tile of the `ico` scheme as exact integers: where it lies on its face, its corners, the vertices of its grid, and
// the tiles that share its edges and corners, over the edges and vertices of the icosahedron too. Thread-safe.
//
// A point of a face is given by its weights at the face's corners 0, 1, 2 (barycentric coordinates) in units of
// 2^-gridLevel: integers >= 0 whose sum is 2^gridLevel. A tile's corners have the grid level of the tile's level, the
// vertices of its grid of `cells` = 2^k cells that of level + k: up to 36 for 64 cells at level 30.
//
// A tile is upright (its corners lie as the face's do) or inverted (turned by half a turn). Corner k of a tile at
// `base` is base + sign e_k, e_k the unit weight of the face's corner k; so the weights of base add up to
// 2^level - sign. Children, of parent corners P_0, P_1, P_2:
//   digit k = 0, 1, 2: corner k is P_k, each other corner j the middle of P_k and P_j. base' = 2 base + sign e_k
//   digit 3:           corner k is the middle of the edge opposite P_k.                base' = 2 base + sign (1, 1, 1),
//                                                                                     sign' = -sign
// So a tile is inverted if its digits have an odd number of threes; corners always run counter-clockwise seen from
// outside; and all tiles of a level are translates of one of two. Edge k lies opposite corner k and runs from corner
// k + 1 to corner k + 2 (mod 3).

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "common/tiling/face_path.h"
#include "common/tiling/icosahedron.h"
#include "common/tiling/triangle_grid.h"

namespace terrane {

using FaceWeights = glm::i64vec3;

struct TriangleTile {
  int face = 0;
  int level = 0;
  int sign = 1;  ///< 1 upright, -1 inverted
  FaceWeights base{0};

  bool operator==(const TriangleTile&) const = default;
};

/// Precondition: path is of the scheme Ico.
TriangleTile triangleTile(const FacePath& path) noexcept;
/// The inverse. Precondition: the tile is on its face, that is, all corners have weights >= 0.
FacePath pathOf(const TriangleTile& tile) noexcept;

/// Corners 0, 1, 2 in units of 2^-level.
std::array<FaceWeights, kTriangleCorners> tileCorners(const TriangleTile& tile) noexcept;
/// The inverse; empty unless the three are, in this order, the corners of a tile of that level.
/// Precondition: 0 <= face < 20, 0 <= level <= FacePath::kMaxLevel.
std::optional<TriangleTile> tileWithCorners(int face, int level,
                                            const std::array<FaceWeights, kTriangleCorners>& corners) noexcept;

/// A vertex of the tile's grid, in units of 2^-level / cells. Precondition: the vertex is of the grid.
FaceWeights gridVertexWeights(const TriangleTile& tile, int cells, const GridVertex& vertex) noexcept;
/// The inverse; empty if the point is outside of the tile.
std::optional<GridVertex> gridVertexAt(const TriangleTile& tile, int cells, const FaceWeights& weights) noexcept;

}  // namespace terrane

#pragma once
// The cells in which grains lie, one at most in each: those of a class are the cells of the grids that tiles of the
// class' level have, of a square's and a triangle's grid. A place is exact in the cells of every tile that it may be
// drawn by, and in one tile of each level. Deterministic: integers and + - x / sqrt in double. Thread-safe.

#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "common/tiling/face_path.h"
#include "common/tiling/triangle_tile.h"

namespace terrane {

/// Cells along a tile's edge.
inline constexpr int kGrainCells = 64;
inline constexpr int kLog2GrainCells = 6;

struct GrainPlace {
  glm::dvec2 cells{0.0};      ///< of the tile's mesh, along i and j from vertex (0, 0)
  glm::dvec3 direction{0.0};  ///< unit, body frame, to some 1e-15
};

/// A square of the cube's grid, half open, by column and row. A place is one double in each direction of the class'
/// grid: tiles differ by powers of two.
struct SquareGrainCell {
  /// On the sphere on average, in squares of its nominal width: (4 pi / 6) / (pi / 2)^2.
  static constexpr double kAreaInWidths = 0.8488263631567752;
  int face = 0, classLevel = 0;
  std::uint64_t column = 0, row = 0;

  /// Calls use(cell) for each that has a part in the tile, by row, then column. Precondition: classLevel <=
  /// tile.level().
  template <class Use>
  static void eachOf(const FacePath& tile, int classLevel, const Use& use) {
    const int down = tile.level() - classLevel;
    const std::uint64_t count = down < kLog2GrainCells ? kGrainCells >> down : 1;
    const std::uint64_t firstColumn = (std::uint64_t{tile.column()} * kGrainCells) >> down,
                        firstRow = (std::uint64_t{tile.row()} * kGrainCells) >> down;
    for (std::uint64_t row = firstRow; row < firstRow + count; ++row)
      for (std::uint64_t column = firstColumn; column < firstColumn + count; ++column)
        use(SquareGrainCell{tile.face(), classLevel, column, row});
  }

  /// A number that no other face or class has.
  std::uint64_t stream() const noexcept { return static_cast<std::uint64_t>(8 * classLevel + face + 1); }
  /// Of a disc as wide as that share of the cell's width, by two numbers in [0, 1), wholly within the cell. Empty where
  /// its middle is not in the tile.
  std::optional<GrainPlace> place(const FacePath& tile, double share, double first, double second) const noexcept;
};

/// A triangle of the icosahedron's grid: a tile of classLevel + 6 (triangle_tile.h). column: twice its base's weight at
/// corner 1, and one more if it is inverted; row: the weight at corner 2.
///
/// Places are whole numbers of 2^-58 / 3 of a face, none of them a multiple of three: so that none lies on a border
/// between tiles, which do, at whole multiples of 2^-30 and coarser.
struct TriangleGrainCell {
  static constexpr double kAreaInWidths = 0.5125920681;  ///< (4 pi / 20) / (atan 2)^2
  TriangleTile triangle;
  int classLevel = 0;
  std::uint64_t column = 0, row = 0;

  template <class Use>
  static void eachOf(const FacePath& tile, int classLevel, const Use& use) {
    const int down = tile.level() - classLevel;
    if (down >= kLog2GrainCells) {
      use(TriangleGrainCell(triangleTile(tile.ancestor(classLevel + kLog2GrainCells)), classLevel));
      return;
    }
    const TriangleTile whole = triangleTile(tile);
    const int count = kGrainCells >> down;
    for (int j = 0; j < count; ++j) {
      for (int i = 0; i + j < count; ++i) {
        use(part(whole, count, {count - 1 - i - j, i, j}, 1, classLevel));
        if (i + j + 1 < count) use(part(whole, count, {count - 1 - i - j, i + 1, j + 1}, -1, classLevel));
      }
    }
  }

  std::uint64_t stream() const noexcept {
    return static_cast<std::uint64_t>(32 * classLevel + triangle.face + 1) << 32;
  }
  std::optional<GrainPlace> place(const FacePath& tile, double share, double first, double second) const noexcept;

 private:
  TriangleGrainCell(const TriangleTile& cell, int classOfCell) noexcept
      : triangle(cell),
        classLevel(classOfCell),
        column(2 * static_cast<std::uint64_t>(cell.base.y) + (cell.sign < 0 ? 1 : 0)),
        row(static_cast<std::uint64_t>(cell.base.z)) {}
  static TriangleGrainCell part(const TriangleTile& whole, int count, const FaceWeights& from, int sign,
                                int classLevel) noexcept {
    return {{whole.face, classLevel + kLog2GrainCells, whole.sign * sign,
             whole.base * std::int64_t{count} + from * std::int64_t{whole.sign}},
            classLevel};
  }
};

}  // namespace terrane

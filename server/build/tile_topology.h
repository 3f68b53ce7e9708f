#pragma once
// What all tiles of a kind share: which vertices exist, how triangles join them, which edge vertex each skirt vertex
// hangs from. Made once per scheme and number of cells and never changed. Thread-safe.
//
// A cube tile's grid vertex (i, j), i along u, is j * (cells + 1) + i. Every cell is cut from (i, j) to (i + 1, j + 1):
// all diagonals run the same way, so that the diagonal of a coarse cell is two diagonals of fine ones. An ico tile's is
// triangleGridIndex (triangle_grid.h).
//
// Skirt vertices follow edge by edge, each edge walked counter-clockwise as seen from outside, its two corners
// included, and begun where the one before ends: VMin, UMax, VMax, UMin of a cube tile, 0, 1, 2 of an ico tile.

#include <cstdint>
#include <memory>
#include <vector>

#include "common/tiling/face_path.h"

namespace terrane {

struct TileTopology {
  int cellsPerEdge = 0;
  std::vector<std::uint32_t>
      triangles;  ///< 3 vertex indices each, counter-clockwise from outside; the grid's, then the skirts'
  std::vector<std::uint32_t> skirtAnchors;  ///< the grid vertex that each skirt vertex hangs from
  std::vector<std::uint16_t> gridIndices;   ///< 0 .. vertexCount - 1

  std::size_t gridVertexCount() const noexcept { return gridIndices.size() - skirtAnchors.size(); }
  std::size_t edgeCount() const noexcept { return skirtAnchors.size() / (static_cast<std::size_t>(cellsPerEdge) + 1); }
};

/// Precondition: 1 <= cellsPerEdge <= 250 (16-bit grid indices).
std::shared_ptr<const TileTopology> makeTileTopology(Scheme scheme, int cellsPerEdge);

}  // namespace terrane

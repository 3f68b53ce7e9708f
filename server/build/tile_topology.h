#pragma once
// What all tiles of a kind share: which vertices exist, how triangles join them, which edge vertex each skirt vertex
// hangs from. Made once per number of cells and never changed. Thread-safe.
//
// Grid vertex (i, j), i along u, is j * (cells + 1) + i. Skirt vertices follow in the order VMin, UMax, VMax, UMin,
// each edge walked counter-clockwise as seen from outside, its two corners included. Every cell is cut from (i, j) to
// (i + 1, j + 1): all diagonals run the same way, so that the diagonal of a coarse cell is two diagonals of fine ones.

#include <cstdint>
#include <memory>
#include <vector>

namespace terrane {

struct TileTopology {
  int cellsPerEdge = 0;
  std::vector<std::uint32_t>
      triangles;  ///< 3 vertex indices each, counter-clockwise from outside; the grid's, then the skirts'
  std::vector<std::uint32_t> skirtAnchors;  ///< the grid vertex that each skirt vertex hangs from
  std::vector<std::uint16_t> gridIndices;   ///< 0 .. vertexCount - 1

  std::size_t gridVertexCount() const noexcept { return gridIndices.size() - skirtAnchors.size(); }
};

/// Precondition: 1 <= cellsPerEdge <= 250 (16-bit grid indices).
std::shared_ptr<const TileTopology> makeTileTopology(int cellsPerEdge);

}  // namespace terrane

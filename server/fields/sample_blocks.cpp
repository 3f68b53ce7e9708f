#include "server/fields/sample_blocks.h"

#include <algorithm>

#include "common/numerics/strict_math.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {
namespace {

std::size_t pieces(std::size_t n, std::size_t most) noexcept { return (n + most - 1) / most; }

/// A grid's border, edge by edge: a corner is of the first that has it.
std::vector<std::vector<std::uint32_t>> edgesOf(const TileGrid& grid) {
  std::vector<std::vector<std::uint32_t>> edges(grid.isSquare() ? 4 : 3);
  for (GridVertex at; at.j <= grid.cells; ++at.j) {
    for (at.i = 0; at.i <= grid.rowEnd(at.j); ++at.i) {
      const unsigned borders = grid.borders(at);
      if (borders == 0) continue;
      std::size_t edge = 0;
      while ((borders & grid.borderOf(static_cast<int>(edge))) == 0) ++edge;
      edges[edge].push_back(static_cast<std::uint32_t>(grid.index(at)));
    }
  }
  return edges;
}

}  // namespace

SampleBlocks::SampleBlocks(std::size_t rows, std::size_t rowLength, const std::optional<TileGrid>& grid)
    : rows_(rows), rowLength_(rowLength), grid_(grid) {
  std::vector<bool> isOnBorder(rows * rowLength, false);
  const auto edges = grid ? edgesOf(*grid) : std::vector<std::vector<std::uint32_t>>();
  for (const auto& edge : edges)
    for (const std::uint32_t sample : edge) isOnBorder[sample] = true;
  listInside(isOnBorder);
  insideCount_ = ends_.size();
  listBorder(edges);
}

/// A block's samples lie in strips of about four rows, column by column: then 16 in a row, a chunk, lie in a square,
/// and a small crater touches few of them.
void SampleBlocks::listInside(const std::vector<bool>& isOnBorder) {
  const std::size_t blockRows = pieces(rows_, std::max<std::size_t>(1, pieces(rows_, kBlockSide)));
  const std::size_t mostColumns = kBlockSide * kBlockSide / std::max<std::size_t>(1, blockRows);
  const std::size_t blockColumns = pieces(rowLength_, std::max<std::size_t>(1, pieces(rowLength_, mostColumns)));
  for (std::size_t top = 0; top < rows_; top += blockRows) {
    for (std::size_t left = 0; left < rowLength_; left += blockColumns) {
      const std::size_t height = std::min(blockRows, rows_ - top), strips = std::max<std::size_t>(1, height / 4);
      const std::size_t right = std::min(left + blockColumns, rowLength_);
      for (std::size_t strip = 0; strip < strips; ++strip) {
        const std::size_t first = top + height * strip / strips, last = top + height * (strip + 1) / strips;
        for (std::size_t column = left; column < right; ++column) {
          for (std::size_t row = first; row < last; ++row) {
            const std::size_t sample = row * rowLength_ + column;
            if (!isOnBorder[sample]) samples_.push_back(static_cast<std::uint32_t>(sample));
          }
        }
      }
      endBlock();
    }
  }
}

void SampleBlocks::listBorder(const std::vector<std::vector<std::uint32_t>>& edges) {
  for (const auto& edge : edges) {
    for (std::size_t k = 0; k < edge.size(); ++k) {
      samples_.push_back(edge[k]);
      if ((k + 1) % kBlockCapacity == 0) endBlock();
    }
    endBlock();
  }
}

}  // namespace terrane::lunar

#include "server/fields/sample_blocks.h"

#include <algorithm>

#include "common/numerics/strict_math.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {
namespace {

std::size_t pieces(std::size_t n, std::size_t most) noexcept { return (n + most - 1) / most; }

}  // namespace

SampleBlocks::SampleBlocks(std::size_t rows, std::size_t rowLength, const std::optional<TileGrid>& grid)
    : rows_(rows), rowLength_(rowLength), grid_(grid) {
  std::vector<bool> isOnBorder(rows * rowLength, false);
  if (!grid) {
    listInside(isOnBorder);
    insideCount_ = ends_.size();
    return;
  }
  SampleBlocks border(0, 0, std::nullopt);
  border.listBorder(*grid, isOnBorder);
  listInside(isOnBorder);
  insideCount_ = ends_.size();
  const std::size_t inside = samples_.size();
  samples_.insert(samples_.end(), border.samples_.begin(), border.samples_.end());
  for (const std::size_t end : border.ends_) ends_.push_back(inside + end);
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

void SampleBlocks::listBorder(const TileGrid& grid, std::vector<bool>& isOnBorder) {
  for (int edge = 0; edge < (grid.isSquare() ? 4 : 3); ++edge) {
    std::size_t inBlock = 0;
    for (GridVertex at; at.j <= grid.cells; ++at.j) {
      for (at.i = 0; at.i <= grid.rowEnd(at.j); ++at.i) {
        const auto sample = static_cast<std::size_t>(grid.index(at));
        if ((grid.borders(at) & grid.borderOf(edge)) == 0 || isOnBorder[sample]) continue;
        isOnBorder[sample] = true;
        samples_.push_back(static_cast<std::uint32_t>(sample));
        if (++inBlock % kBlockCapacity == 0) endBlock();
      }
    }
    endBlock();
  }
}

}  // namespace terrane::lunar

#include "server/fields/sample_blocks.h"

#include <algorithm>

#include "common/numerics/strict_math.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {
namespace {

constexpr std::size_t kChunkSide = 4;
static_assert(kChunkSide * kChunkSide == kChunk);
/// A grid's border, edge by edge, all as long: going round, a corner is of the edge that it ends.
std::vector<std::vector<std::uint32_t>> edgesOf(const TileGrid& grid) {
  const std::vector<int> round = grid.isSquare() ? std::vector{0, 2, 1, 3} : std::vector{0, 1, 2};
  std::vector<std::vector<std::uint32_t>> edges(round.size());
  for (GridVertex at; at.j <= grid.cells; ++at.j) {
    for (at.i = 0; at.i <= grid.rowEnd(at.j); ++at.i) {
      const unsigned borders = grid.borders(at);
      if (borders == 0) continue;
      const auto isOn = [&](std::size_t k) { return (borders & grid.borderOf(round[k])) != 0; };
      std::size_t edge = 0;
      while (!isOn(edge) || (edge == 0 && isOn(round.size() - 1))) ++edge;
      edges[edge].push_back(static_cast<std::uint32_t>(grid.index(at)));
    }
  }
  return edges;
}

}  // namespace

SampleBlocks::SampleBlocks(std::size_t rows, std::size_t rowLength, const std::optional<TileGrid>& grid)
    : rows_(rows), rowLength_(rowLength), grid_(grid) {
  if (grid) {
    const auto inner = static_cast<std::size_t>(grid->cells - 1);
    listInside(inner, inner, [&](std::size_t row, std::size_t column) -> std::optional<std::size_t> {
      const GridVertex at{static_cast<int>(column) + 1, static_cast<int>(row) + 1};
      if (at.i >= grid->rowEnd(at.j)) return std::nullopt;
      return static_cast<std::size_t>(grid->index(at));
    });
  } else {
    listInside(rows, rowLength, [&](std::size_t row, std::size_t column) -> std::optional<std::size_t> {
      return row * rowLength + column;
    });
  }
  insideCount_ = ends_.size();
  if (grid) listBorder(edgesOf(*grid));
}

/// In blocks of four strips of four rows, column by column: then a chunk is a square of 4 x 4 samples, and a small
/// crater touches few of them. Where the last of a strip's chunks is not full, its last sample is listed again.
template <class SampleAt>
void SampleBlocks::listInside(std::size_t rows, std::size_t columns, const SampleAt& sampleAt) {
  if (rows == 0 || columns == 0) return;
  const std::size_t stripRows = std::min(kChunkSide, rows), blockRows = std::min(4 * kChunkSide, rows);
  const std::size_t strips = (blockRows + stripRows - 1) / stripRows;
  const std::size_t blockColumns = kBlockChunks / strips * kChunk / stripRows;
  for (std::size_t top = 0; top < rows; top += blockRows) {
    for (std::size_t left = 0; left < columns; left += blockColumns) {
      const std::size_t bottom = std::min(top + blockRows, rows), right = std::min(left + blockColumns, columns);
      for (std::size_t first = top; first < bottom; first += stripRows) {
        const std::size_t begin = samples_.size();
        for (std::size_t column = left; column < right; ++column)
          for (std::size_t row = first; row < std::min(first + stripRows, bottom); ++row)
            if (const auto sample = sampleAt(row, column)) samples_.push_back(static_cast<std::uint32_t>(*sample));
        while ((samples_.size() - begin) % kChunk != 0) samples_.push_back(samples_.back());
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

#pragma once
// How a batch of samples is cut into blocks for the kernels: which samples, in which order. Depends on the batch's
// shape alone, and is made once for each. Belongs to one thread.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/tiling/tile_grid.h"

namespace terrane::lunar {

class SampleBlocks {
 public:
  /// The samples of a batch of rows x rowLength in compact blocks of at most kBlockCapacity, some of them more than
  /// once. With a grid, whose vertices the samples are by index, those on its border follow, each once, in blocks of
  /// their own, edge by edge.
  SampleBlocks(std::size_t rows, std::size_t rowLength, const std::optional<TileGrid>& grid);

  std::size_t count() const noexcept { return ends_.size(); }
  /// Those inside the grid come first.
  std::size_t insideCount() const noexcept { return insideCount_; }
  std::span<const std::uint32_t> operator[](std::size_t block) const noexcept {
    const std::size_t begin = block == 0 ? 0 : ends_[block - 1];
    return std::span(samples_).subspan(begin, ends_[block] - begin);
  }

  bool isOf(std::size_t rows, std::size_t rowLength, const std::optional<TileGrid>& grid) const noexcept {
    return rows_ == rows && rowLength_ == rowLength && grid_ == grid;
  }

 private:
  /// sampleAt(row, column): a sample, or none.
  template <class SampleAt>
  void listInside(std::size_t rows, std::size_t columns, const SampleAt& sampleAt);
  void listBorder(const std::vector<std::vector<std::uint32_t>>& edges);
  void endBlock() {
    if (samples_.size() > (ends_.empty() ? 0 : ends_.back())) ends_.push_back(samples_.size());
  }

  std::size_t rows_, rowLength_;
  std::optional<TileGrid> grid_;
  std::vector<std::uint32_t> samples_;
  std::vector<std::size_t> ends_;  ///< of each block in samples_
  std::size_t insideCount_ = 0;
};

}  // namespace terrane::lunar

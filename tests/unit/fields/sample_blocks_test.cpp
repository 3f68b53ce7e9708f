#include "server/fields/sample_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "server/fields/lunar_program.h"

namespace terrane::lunar {
namespace {

struct Shape {
  std::size_t rows, rowLength;
  std::optional<TileGrid> grid;
};

/// How often each sample of a batch is in a block, none of which may be empty or too large.
std::vector<int> countSamples(const SampleBlocks& blocks, std::size_t count, std::size_t first, std::size_t last) {
  std::vector<int> counts(count, 0);
  for (std::size_t k = first; k < last; ++k) {
    EXPECT_GT(blocks[k].size(), 0u);
    EXPECT_LE(blocks[k].size(), kBlockCapacity);
    for (const std::uint32_t sample : blocks[k]) ++counts.at(sample);
  }
  return counts;
}

TEST(SampleBlocks, HoldEverySampleOnce) {
  for (const Shape& shape : {Shape{1, 1, {}}, Shape{1, 129, {}}, Shape{2, 2, {}}, Shape{65, 65, {}},
                             Shape{65, 65, TileGrid{Scheme::Cube, 64}}, Shape{33, 65, TileGrid{Scheme::Ico, 64}},
                             Shape{3, 3, TileGrid{Scheme::Cube, 2}}, Shape{2, 3, TileGrid{Scheme::Ico, 2}},
                             Shape{251, 251, TileGrid{Scheme::Cube, 250}}}) {
    const SampleBlocks blocks(shape.rows, shape.rowLength, shape.grid);
    EXPECT_TRUE(blocks.isOf(shape.rows, shape.rowLength, shape.grid));
    const std::vector<int> counts = countSamples(blocks, shape.rows * shape.rowLength, 0, blocks.count());
    EXPECT_TRUE(std::all_of(counts.begin(), counts.end(), [](int n) { return n == 1; }))
        << shape.rows << " x " << shape.rowLength;
  }
}

TEST(SampleBlocks, KeepAGridsBorderApart) {
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    const TileGrid grid{scheme, 64};
    const std::size_t count = static_cast<std::size_t>(grid.vertexCount());
    const SampleBlocks blocks(count / 65, 65, grid);
    const std::vector<int> onBorder = countSamples(blocks, count, blocks.insideCount(), blocks.count());
    for (GridVertex at; at.j <= grid.cells; ++at.j) {
      for (at.i = 0; at.i <= grid.rowEnd(at.j); ++at.i)
        EXPECT_EQ(onBorder[static_cast<std::size_t>(grid.index(at))], grid.borders(at) != 0 ? 1 : 0);
    }
  }
}

/// Chunks are compact: or a small crater would touch many of them.
TEST(SampleBlocks, HaveChunksOfFourByFour) {
  const SampleBlocks blocks(65, 65, std::nullopt);
  std::size_t wide = 0, chunks = 0;
  for (std::size_t k = 0; k < blocks.count(); ++k) {
    const auto samples = blocks[k];
    for (std::size_t begin = 0; begin + kChunk <= samples.size(); begin += kChunk, ++chunks) {
      std::size_t low = 1000, high = 0;
      for (const std::uint32_t sample : samples.subspan(begin, kChunk)) {
        low = std::min<std::size_t>(low, sample % 65);
        high = std::max<std::size_t>(high, sample % 65);
      }
      wide += high - low > 5 ? 1 : 0;
    }
  }
  EXPECT_LT(wide, chunks / 4);
}

}  // namespace
}  // namespace terrane::lunar

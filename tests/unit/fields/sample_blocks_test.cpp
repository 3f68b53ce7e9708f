#include "server/fields/sample_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

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

TEST(SampleBlocks, HoldEverySampleAndFewTwice) {
  for (std::size_t rows = 1; rows <= 40; ++rows)
    for (std::size_t rowLength = 1; rowLength <= 100; rowLength += 3) {
      const SampleBlocks blocks(rows, rowLength, {});
      const std::vector<int> counts = countSamples(blocks, rows * rowLength, 0, blocks.count());
      ASSERT_TRUE(std::all_of(counts.begin(), counts.end(), [](int n) { return n >= 1; }))
          << rows << " x " << rowLength;
    }
  for (const Shape& shape : {Shape{1, 1, {}}, Shape{1, 129, {}}, Shape{2, 2, {}}, Shape{65, 65, {}},
                             Shape{65, 65, TileGrid{Scheme::Cube, 64}}, Shape{33, 65, TileGrid{Scheme::Ico, 64}},
                             Shape{3, 3, TileGrid{Scheme::Cube, 2}}, Shape{2, 3, TileGrid{Scheme::Ico, 2}},
                             Shape{251, 251, TileGrid{Scheme::Cube, 250}}}) {
    const SampleBlocks blocks(shape.rows, shape.rowLength, shape.grid);
    EXPECT_TRUE(blocks.isOf(shape.rows, shape.rowLength, shape.grid));
    const std::vector<int> counts = countSamples(blocks, shape.rows * shape.rowLength, 0, blocks.count());
    EXPECT_TRUE(std::all_of(counts.begin(), counts.end(), [](int n) { return n >= 1; }))
        << shape.rows << " x " << shape.rowLength;
    if (counts.size() < 1000) continue;
    const int listed = std::accumulate(counts.begin(), counts.end(), 0);
    EXPECT_LT(listed, 1.15 * static_cast<double>(counts.size())) << shape.rows << " x " << shape.rowLength;
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
    for (std::size_t k = blocks.insideCount(); k < blocks.count(); ++k) EXPECT_EQ(blocks[k].size(), 64u);
  }
}

/// Chunks are compact: or a small crater would touch many of them.
TEST(SampleBlocks, HaveChunksOfFourByFour) {
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    const TileGrid grid{scheme, 64};
    std::vector<GridVertex> vertices(static_cast<std::size_t>(grid.vertexCount()));
    for (GridVertex at; at.j <= grid.cells; ++at.j)
      for (at.i = 0; at.i <= grid.rowEnd(at.j); ++at.i) vertices[static_cast<std::size_t>(grid.index(at))] = at;
    const SampleBlocks blocks(vertices.size() / 65, 65, grid);
    std::size_t square = 0, chunks = 0;
    for (std::size_t k = 0; k < blocks.insideCount(); ++k) {
      ASSERT_EQ(blocks[k].size() % kChunk, 0u);
      for (std::size_t begin = 0; begin < blocks[k].size(); begin += kChunk, ++chunks) {
        GridVertex low{1000, 1000}, high{0, 0};
        for (const std::uint32_t sample : blocks[k].subspan(begin, kChunk)) {
          const GridVertex at = vertices[sample];
          low = {std::min(low.i, at.i), std::min(low.j, at.j)};
          high = {std::max(high.i, at.i), std::max(high.j, at.j)};
        }
        square += high.i - low.i <= 3 && high.j - low.j <= 3 ? 1 : 0;
      }
    }
    EXPECT_GT(square, chunks * 8 / 10) << square << " of " << chunks;
  }
}

}  // namespace
}  // namespace terrane::lunar

// The triangles of a complete grid, whole and stitched to coarser neighbours: each covers the square once, and its
// border has just the vertices that the neighbours have.

#include "client/render/tile_indices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <set>

#include "tests/capture/gl_fixture.h"

namespace terrane {
namespace {

struct Corner {
  int i, j;
};
Corner cornerOf(std::uint16_t index, int cells) { return {index % (cells + 1), index / (cells + 1)}; }

/// Twice the area, positive if counter-clockwise.
int areaOf(Corner a, Corner b, Corner c) { return (b.i - a.i) * (c.j - a.j) - (c.i - a.i) * (b.j - a.j); }

/// Counter-clockwise around the grid, without the odd vertices of coarser edges: directed edges from vertex to vertex.
std::set<std::pair<int, int>> expectedBorder(int cells, unsigned coarserEdges) {
  std::set<std::pair<int, int>> border;
  for (int edge = 0; edge < kEdgeCount; ++edge) {
    const int stride = ((coarserEdges >> edge) & 1u) != 0 ? 2 : 1;
    for (int k = 0; k < cells; k += stride) {
      const int next = k + stride, side = cells + 1;
      switch (static_cast<Side>(edge)) {
        case Side::UMin:
          border.emplace(next * side, k * side);
          break;
        case Side::UMax:
          border.emplace(k * side + cells, next * side + cells);
          break;
        case Side::VMin:
          border.emplace(k, next);
          break;
        default:
          border.emplace(cells * side + next, cells * side + k);
          break;
      }
    }
  }
  return border;
}

TEST(TileIndices, EveryStitchingCoversTheGridOnceAndMeetsItsNeighboursVertexForVertex) {
  for (const int cells : {2, 4, 16, 64}) {
    for (unsigned edges = 0; edges < 16; ++edges) {
      const std::vector<std::uint16_t> indices = gridTriangles(cells, edges);
      EXPECT_EQ(indices.size() / 3, static_cast<std::size_t>(2 * cells * cells - cells / 2 * std::popcount(edges)));
      int area = 0;
      std::set<std::pair<int, int>> open;
      for (std::size_t t = 0; t < indices.size(); t += 3) {
        const int twice =
            areaOf(cornerOf(indices[t], cells), cornerOf(indices[t + 1], cells), cornerOf(indices[t + 2], cells));
        ASSERT_GT(twice, 0) << "a triangle turned over, " << cells << " cells, edges " << edges;
        area += twice;
        for (std::size_t c = 0; c < 3; ++c) {
          const int from = indices[t + c], to = indices[t + (c + 1) % 3];
          const bool closes = open.erase({to, from}) != 0;
          ASSERT_TRUE(closes || open.emplace(from, to).second);
        }
      }
      EXPECT_EQ(area, 2 * cells * cells) << cells << " cells, edges " << edges;
      EXPECT_EQ(open, expectedBorder(cells, edges)) << cells << " cells, edges " << edges;
    }
  }
}

class TileIndicesOfMeshes : public GlTest {};

TEST_F(TileIndicesOfMeshes, AGridIsKnownInAnyOrderAndNothingElseIsTakenForOne) {
  const TileMesh& built = moon().tile(FacePath::cubeTile(2, 3, 1, 5))->mesh;
  constexpr int kCells = 64;
  constexpr unsigned kSeed = 91;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  std::vector<std::uint32_t> places(built.vertexCount());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = static_cast<std::uint32_t>(i);
  std::ranges::shuffle(places, random);
  TileMesh mesh = built;
  for (std::size_t i = 0; i < places.size(); ++i) mesh.gridIndices[places[i]] = built.gridIndices[i];
  for (std::uint32_t& vertex : mesh.triangles) vertex = places[vertex];
  std::rotate(mesh.triangles.begin(), mesh.triangles.begin() + 3 * 777, mesh.triangles.end());
  const auto order = verticesInGridOrder(mesh, kCells);
  ASSERT_TRUE(order);
  for (std::size_t g = 0; g < order->size(); ++g) ASSERT_EQ((*order)[g], places[g]);

  EXPECT_FALSE(verticesInGridOrder(mesh, kCells - 1));
  TileMesh wrong = mesh;
  wrong.gridIndices[0] = wrong.gridIndices[1];
  EXPECT_FALSE(verticesInGridOrder(wrong, kCells)) << "one place taken twice";
  wrong = mesh;
  std::swap(wrong.triangles[30], wrong.triangles[31]);
  EXPECT_FALSE(verticesInGridOrder(wrong, kCells)) << "a triangle turned over";
  wrong = mesh;
  wrong.triangles.resize(wrong.triangles.size() - 3);
  EXPECT_FALSE(verticesInGridOrder(wrong, kCells)) << "a triangle missing";
  wrong = mesh;
  std::copy_n(wrong.triangles.begin(), 3, wrong.triangles.begin() + 3);
  EXPECT_FALSE(verticesInGridOrder(wrong, kCells)) << "a triangle twice";
}

}  // namespace
}  // namespace terrane

// The triangles of a complete grid, whole and stitched to coarser neighbours: each covers the square once, and its
// border has just the vertices that the neighbours have.

#include "client/render/tile_indices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <set>

#include "common/tiling/tile_at.h"
#include "tests/capture/gl_fixture.h"

namespace terrane {
namespace {

/// Twice the area, positive if counter-clockwise.
int areaOf(const GridVertex& a, const GridVertex& b, const GridVertex& c) {
  return (b.i - a.i) * (c.j - a.j) - (c.i - a.i) * (b.j - a.j);
}

std::vector<GridVertex> byIndex(const TileGrid& grid) {
  std::vector<GridVertex> vertices(static_cast<std::size_t>(grid.vertexCount()));
  for (int j = 0; j <= grid.cells; ++j)
    for (int i = 0; grid.has({i, j}); ++i) vertices[static_cast<std::size_t>(grid.index({i, j}))] = {i, j};
  return vertices;
}

/// Counter-clockwise around the grid, without the odd vertices of coarser edges: directed edges from vertex to vertex.
std::set<std::pair<int, int>> expectedBorder(const TileGrid& grid, unsigned coarserEdges) {
  std::set<std::pair<int, int>> border;
  for (int edge = 0; edge < edgeCount(grid.scheme); ++edge) {
    const int stride = ((coarserEdges >> edge) & 1u) != 0 ? 2 : 1, cells = grid.cells;
    const auto at = [&](int k) {  // counter-clockwise
      if (!grid.isSquare()) return grid.index(edgeVertex(cells, edge, k));
      switch (static_cast<Side>(edge)) {
        case Side::UMin:
          return grid.index({0, cells - k});
        case Side::UMax:
          return grid.index({cells, k});
        case Side::VMin:
          return grid.index({k, 0});
        default:
          return grid.index({cells - k, cells});
      }
    };
    for (int k = 0; k < cells; k += stride) border.emplace(at(k), at(k + stride));
  }
  return border;
}

class TileIndicesOfGrids : public testing::TestWithParam<Scheme> {};

TEST_P(TileIndicesOfGrids, EveryStitchingCoversTheGridOnceAndMeetsItsNeighboursVertexForVertex) {
  const int trianglesInCell = GetParam() == Scheme::Cube ? 2 : 1;  // on average
  for (const int cells : {2, 4, 16, 64}) {
    const TileGrid grid{GetParam(), cells};
    const std::vector<GridVertex> vertices = byIndex(grid);
    for (unsigned edges = 0; edges < 1u << edgeCount(GetParam()); ++edges) {
      const std::vector<std::uint16_t> indices = gridTriangles(grid, edges);
      EXPECT_EQ(indices.size() / 3,
                static_cast<std::size_t>(trianglesInCell * cells * cells - cells / 2 * std::popcount(edges)));
      int area = 0;
      std::set<std::pair<int, int>> open;
      for (std::size_t t = 0; t < indices.size(); t += 3) {
        const int twice = areaOf(vertices.at(indices[t]), vertices.at(indices[t + 1]), vertices.at(indices[t + 2]));
        ASSERT_GT(twice, 0) << "a triangle turned over, " << cells << " cells, edges " << edges;
        area += twice;
        for (std::size_t c = 0; c < 3; ++c) {
          const int from = indices[t + c], to = indices[t + (c + 1) % 3];
          const bool closes = open.erase({to, from}) != 0;
          ASSERT_TRUE(closes || open.emplace(from, to).second);
        }
      }
      EXPECT_EQ(area, trianglesInCell * cells * cells) << cells << " cells, edges " << edges;
      EXPECT_EQ(open, expectedBorder(grid, edges)) << cells << " cells, edges " << edges;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, TileIndicesOfGrids, test::bothSchemes(), test::nameOfScheme);

class TileIndicesOfMeshes : public GlTestOfSchemes {};

TEST_P(TileIndicesOfMeshes, AGridIsKnownInAnyOrderAndNothingElseIsTakenForOne) {
  const TileMesh& built = tiles().tile(tileAt(GetParam(), glm::dvec3(0.2, 0.9, 0.1), 3))->mesh;
  const TileGrid grid{GetParam(), 64};
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
  const auto order = verticesInGridOrder(mesh, grid);
  ASSERT_TRUE(order);
  for (std::size_t g = 0; g < order->size(); ++g) ASSERT_EQ((*order)[g], places[g]);

  EXPECT_FALSE(verticesInGridOrder(mesh, {GetParam(), 63}));
  EXPECT_FALSE(verticesInGridOrder(mesh, {GetParam() == Scheme::Cube ? Scheme::Ico : Scheme::Cube, 64}));
  TileMesh wrong = mesh;
  wrong.gridIndices[0] = wrong.gridIndices[1];
  EXPECT_FALSE(verticesInGridOrder(wrong, grid)) << "one place taken twice";
  wrong = mesh;
  std::swap(wrong.triangles[30], wrong.triangles[31]);
  EXPECT_FALSE(verticesInGridOrder(wrong, grid)) << "a triangle turned over";
  wrong = mesh;
  wrong.triangles.resize(wrong.triangles.size() - 3);
  EXPECT_FALSE(verticesInGridOrder(wrong, grid)) << "a triangle missing";
  wrong = mesh;
  std::copy_n(wrong.triangles.begin(), 3, wrong.triangles.begin() + 3);
  EXPECT_FALSE(verticesInGridOrder(wrong, grid)) << "a triangle twice";
}

INSTANTIATE_TEST_SUITE_P(Schemes, TileIndicesOfMeshes, test::bothSchemes(), test::nameOfScheme);

}  // namespace
}  // namespace terrane

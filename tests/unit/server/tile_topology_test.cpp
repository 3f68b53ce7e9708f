#include "server/build/tile_topology.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <map>
#include <utility>
#include <vector>

#include "common/tiling/tile_neighbours.h"
#include "common/tiling/triangle_grid.h"
#include "tests/support/both_schemes.h"

namespace terrane {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::map<Edge, int> directedEdges(const TileTopology& topology) {
  std::map<Edge, int> edges;
  for (std::size_t i = 0; i < topology.triangles.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{topology.triangles[i + k], topology.triangles[i + (k + 1) % 3]}];
  return edges;
}

class TileTopologyOf : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, TileTopologyOf, test::bothSchemes(), test::nameOfScheme);

TEST_P(TileTopologyOf, WalksEveryEdgeOnceInEachDirectionButForTheBottomsAndEndsOfSkirts) {
  const auto topology = makeTileTopology(GetParam(), 8);
  const auto edges = static_cast<std::size_t>(edgeCount(GetParam()));
  EXPECT_EQ(topology->edgeCount(), edges);
  // As many triangles as cells allow: two in each square, a triangle's number squared, two below each edge's cell.
  EXPECT_EQ(topology->triangles.size(), 3 * ((GetParam() == Scheme::Cube ? 128 : 64) + edges * 16));
  int open = 0;
  for (const auto& [edge, count] : directedEdges(*topology)) {
    EXPECT_EQ(count, 1);
    if (directedEdges(*topology).contains({edge.second, edge.first})) continue;
    ++open;
    const bool bottom = edge.first >= topology->gridVertexCount() || edge.second >= topology->gridVertexCount();
    EXPECT_TRUE(bottom) << "an open edge of the surface itself";
  }
  EXPECT_EQ(static_cast<std::size_t>(open), edges * (8 + 2));
}

TEST(TileTopology, HangsSkirtsInTheDocumentedOrder) {
  constexpr std::uint32_t kCells = 4, kSide = kCells + 1;
  const auto topology = makeTileTopology(Scheme::Cube, kCells);
  ASSERT_EQ(topology->skirtAnchors.size(), 4 * kSide);
  const auto corner = [&](std::uint32_t edge, std::uint32_t k) { return topology->skirtAnchors[edge * kSide + k]; };
  const std::uint32_t v00 = 0, v10 = kCells, v11 = kSide * kSide - 1, v01 = kCells * kSide;
  const std::uint32_t ends[4][2] = {{v00, v10}, {v10, v11}, {v11, v01}, {v01, v00}};
  for (std::uint32_t edge = 0; edge < 4; ++edge) {
    EXPECT_EQ(corner(edge, 0), ends[edge][0]);
    EXPECT_EQ(corner(edge, kCells), ends[edge][1]);
  }
}

/// A flat tile with the eye above it: corners in counter-clockwise order, skirts hang down.
glm::dvec3 flatPlace(Scheme scheme, const TileTopology& topology, std::uint32_t vertex) {
  const bool skirt = vertex >= topology.gridVertexCount();
  const std::uint32_t grid = skirt ? topology.skirtAnchors[vertex - topology.gridVertexCount()] : vertex;
  const double height = skirt ? -1.0 : 0.0;
  const int cells = topology.cellsPerEdge, side = cells + 1, index = static_cast<int>(grid);
  if (scheme == Scheme::Cube) return {index % side, index / side, height};
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i + j <= cells; ++i)
      if (triangleGridIndex(cells, {i, j}) == index) return {i, j, height};
  ADD_FAILURE() << "no vertex " << grid;
  return {};
}

TEST_P(TileTopologyOf, FacesTheGridOutwardsAndSkirtsAwayFromTheTile) {
  constexpr int kCells = 4;
  const auto topology = makeTileTopology(GetParam(), kCells);
  const glm::dvec3 center = glm::dvec3(kCells, kCells, 0) / (GetParam() == Scheme::Cube ? 2.0 : 3.0);
  for (std::size_t i = 0; i < topology->triangles.size(); i += 3) {
    const auto at = [&](std::size_t k) { return flatPlace(GetParam(), *topology, topology->triangles[i + k]); };
    const glm::dvec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
    const glm::dvec3 outwards = (at(0) + at(1) + at(2)) / 3.0 - center;
    const bool skirt = at(0).z + at(1).z + at(2).z < 0;
    EXPECT_EQ(skirt, i >= topology->triangles.size() - 6 * kCells * topology->edgeCount());
    EXPECT_GT(skirt ? normal.x * outwards.x + normal.y * outwards.y : normal.z, 0);
  }
}

TEST_P(TileTopologyOf, ASkirtBeginsWhereTheOneBeforeEnds) {
  constexpr std::size_t kCells = 8;
  const auto topology = makeTileTopology(GetParam(), kCells);
  for (std::size_t edge = 0; edge < topology->edgeCount(); ++edge) {
    const std::size_t next = (edge + 1) % topology->edgeCount();
    EXPECT_EQ(topology->skirtAnchors[edge * (kCells + 1) + kCells], topology->skirtAnchors[next * (kCells + 1)]);
  }
}

TEST(TileTopology, SkirtsOfTrianglesFollowTheEdgesAsTheyAreNumbered) {
  const auto topology = makeTileTopology(Scheme::Ico, 4);
  ASSERT_EQ(topology->gridVertexCount(), 15u);
  const std::vector<std::uint32_t> expected{4, 8, 11, 13, 14, 14, 12, 9, 5, 0, 0, 1, 2, 3, 4};
  EXPECT_EQ(topology->skirtAnchors, expected);
}

TEST(TileTopology, RunsAllDiagonalsTheSameWaySoThatCoarseOnesAreFineOnes) {
  const auto fine = directedEdges(*makeTileTopology(Scheme::Cube, 8));
  for (std::uint32_t j = 0; j < 8; ++j)
    for (std::uint32_t i = 0; i < 8; ++i) EXPECT_TRUE(fine.contains({j * 9 + i, (j + 1) * 9 + i + 1}));
}

}  // namespace
}  // namespace terrane

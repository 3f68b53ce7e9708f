#include "server/build/tile_topology.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <utility>

namespace terrane {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::map<Edge, int> directedEdges(const TileTopology& topology) {
  std::map<Edge, int> edges;
  for (std::size_t i = 0; i < topology.triangles.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{topology.triangles[i + k], topology.triangles[i + (k + 1) % 3]}];
  return edges;
}

TEST(TileTopology, WalksEveryEdgeOnceInEachDirectionButForTheBottomsAndEndsOfSkirts) {
  const auto topology = makeTileTopology(8);
  int open = 0;
  for (const auto& [edge, count] : directedEdges(*topology)) {
    EXPECT_EQ(count, 1);
    if (directedEdges(*topology).contains({edge.second, edge.first})) continue;
    ++open;
    const bool bottom = edge.first >= topology->gridVertexCount() || edge.second >= topology->gridVertexCount();
    EXPECT_TRUE(bottom) << "an open edge of the surface itself";
  }
  EXPECT_EQ(open, 4 * (8 + 2));
}

TEST(TileTopology, HangsSkirtsInTheDocumentedOrder) {
  constexpr std::uint32_t kCells = 4, kSide = kCells + 1;
  const auto topology = makeTileTopology(kCells);
  ASSERT_EQ(topology->skirtAnchors.size(), 4 * kSide);
  const auto corner = [&](std::uint32_t edge, std::uint32_t k) { return topology->skirtAnchors[edge * kSide + k]; };
  const std::uint32_t v00 = 0, v10 = kCells, v11 = kSide * kSide - 1, v01 = kCells * kSide;
  const std::uint32_t ends[4][2] = {{v00, v10}, {v10, v11}, {v11, v01}, {v01, v00}};
  for (std::uint32_t edge = 0; edge < 4; ++edge) {
    EXPECT_EQ(corner(edge, 0), ends[edge][0]);
    EXPECT_EQ(corner(edge, kCells), ends[edge][1]);
  }
}

TEST(TileTopology, FacesTheGridOutwardsAndSkirtsAwayFromTheTile) {
  constexpr std::uint32_t kCells = 4, kSide = kCells + 1;
  const auto topology = makeTileTopology(kCells);
  // A flat tile: u to the right, v up, outwards towards the eye; skirts hang down behind it.
  const auto at = [&](std::uint32_t vertex) {
    const bool skirt = vertex >= topology->gridVertexCount();
    const std::uint32_t grid = skirt ? topology->skirtAnchors[vertex - topology->gridVertexCount()] : vertex;
    return std::array<double, 3>{double(grid % kSide), double(grid / kSide), skirt ? -1.0 : 0.0};
  };
  for (std::size_t i = 0; i < topology->triangles.size(); i += 3) {
    const auto a = at(topology->triangles[i]), b = at(topology->triangles[i + 1]), c = at(topology->triangles[i + 2]);
    double e[3], f[3], n[3], middle[2];
    for (std::size_t k = 0; k < 3; ++k) e[k] = b[k] - a[k], f[k] = c[k] - a[k];
    for (std::size_t k = 0; k < 3; ++k) n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    for (std::size_t k = 0; k < 2; ++k) middle[k] = (a[k] + b[k] + c[k]) / 3 - kCells / 2.0;
    if (i < 6 * kCells * kCells) {
      EXPECT_GT(n[2], 0);
    } else {
      EXPECT_GT(n[0] * middle[0] + n[1] * middle[1], 0);
    }
  }
}

TEST(TileTopology, RunsAllDiagonalsTheSameWaySoThatCoarseOnesAreFineOnes) {
  const auto fine = directedEdges(*makeTileTopology(8));
  for (std::uint32_t j = 0; j < 8; ++j)
    for (std::uint32_t i = 0; i < 8; ++i) EXPECT_TRUE(fine.contains({j * 9 + i, (j + 1) * 9 + i + 1}));
}

}  // namespace
}  // namespace terrane

#pragma once
// The vertices along a tile's edges, and that two tiles agree on theirs to the last bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/tiling/lattice.h"
#include "common/tiling/tile_neighbours.h"
#include "common/tiling/triangle_grid.h"
#include "proto/gltf_tile.h"

namespace terrane::testing_support {

/// What a shared vertex must agree in.
struct EdgeVertex {
  LatticePoint point{0};
  std::array<float, 3> normal{};
  std::array<std::uint8_t, 3> color{};
  bool operator==(const EdgeVertex&) const = default;
};

inline std::size_t gridIndexOnEdge(Side edge, std::size_t cells, std::size_t k) {
  const std::size_t side = cells + 1;
  switch (edge) {
    case Side::UMin:
      return k * side;
    case Side::UMax:
      return k * side + cells;
    case Side::VMin:
      return k;
    default:
      return cells * side + k;
  }
}

/// Edges as tile_neighbours.h counts them.
inline std::vector<EdgeVertex> edgeVertices(const Tile& tile, int edge) {
  const int cells = tile.metadata.cellsPerEdge;
  const bool cube = tile.metadata.path.scheme() == Scheme::Cube;
  std::vector<std::size_t> vertexOfGridIndex(tile.mesh.vertexCount());
  for (std::size_t vertex = 0; vertex < tile.mesh.vertexCount(); ++vertex)
    vertexOfGridIndex[tile.mesh.gridIndices[vertex]] = vertex;
  std::vector<EdgeVertex> vertices;
  for (int k = 0; k <= cells; ++k) {
    const std::size_t index =
        cube ? gridIndexOnEdge(static_cast<Side>(edge), static_cast<std::size_t>(cells), static_cast<std::size_t>(k))
             : static_cast<std::size_t>(triangleGridIndex(cells, edgeVertex(cells, edge, k)));
    const std::size_t at = 3 * vertexOfGridIndex[index];
    const auto& [offsets, normals, colors, indices, triangles] = tile.mesh;
    vertices.push_back({tile.metadata.origin + LatticePoint(offsets[at], offsets[at + 1], offsets[at + 2]),
                        {normals[at], normals[at + 1], normals[at + 2]},
                        {}});
    if (!colors.empty()) vertices.back().color = {colors[at], colors[at + 1], colors[at + 2]};
  }
  return vertices;
}
inline std::vector<EdgeVertex> edgeVertices(const Tile& tile, Side edge) {
  return edgeVertices(tile, static_cast<int>(edge));
}

/// The edge of `tile` that lies against `other`. At level 0 and beyond, two tiles share one edge at most.
inline std::optional<int> edgeTowards(const FacePath& tile, const FacePath& other) {
  for (int edge = 0; edge < edgeCount(tile.scheme()); ++edge)
    if (tileBeyondEdge(tile, edge) == other) return edge;
  return std::nullopt;
}

inline void expectSameEdge(const Tile& tile, int edge, const Tile& neighbour) {
  const std::optional<int> back = edgeTowards(neighbour.metadata.path, tile.metadata.path);
  ASSERT_TRUE(back.has_value());
  const std::vector<EdgeVertex> mine = edgeVertices(tile, edge);
  std::vector<EdgeVertex> theirs = edgeVertices(neighbour, *back);
  if (!(theirs.front().point == mine.front().point)) std::reverse(theirs.begin(), theirs.end());
  ASSERT_EQ(tile.metadata.stepExponent, neighbour.metadata.stepExponent);
  EXPECT_EQ(mine, theirs) << tile.metadata.path.text() << " and " << neighbour.metadata.path.text();
}
inline void expectSameEdge(const Tile& tile, Side side, const Tile& neighbour) {
  expectSameEdge(tile, static_cast<int>(side), neighbour);
}

}  // namespace terrane::testing_support

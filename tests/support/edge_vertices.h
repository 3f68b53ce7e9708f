#pragma once
// The vertices along a tile's edges, and that two tiles agree on theirs to the last bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "common/tiling/lattice.h"
#include "proto/gltf_tile.h"

namespace terrane::testing_support {

/// What a shared vertex must agree in.
struct EdgeVertex {
  LatticePoint point{0};
  std::array<float, 3> normal{};
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

inline std::vector<EdgeVertex> edgeVertices(const Tile& tile, Side edge) {
  const auto cells = static_cast<std::size_t>(tile.metadata.cellsPerEdge);
  std::vector<std::size_t> vertexOfGridIndex(tile.mesh.vertexCount());
  for (std::size_t vertex = 0; vertex < tile.mesh.vertexCount(); ++vertex)
    vertexOfGridIndex[tile.mesh.gridIndices[vertex]] = vertex;
  std::vector<EdgeVertex> vertices;
  for (std::size_t k = 0; k <= cells; ++k) {
    const std::size_t at = 3 * vertexOfGridIndex[gridIndexOnEdge(edge, cells, k)];
    const auto& offsets = tile.mesh.offsets;
    const auto& normals = tile.mesh.normals;
    vertices.push_back({tile.metadata.origin + LatticePoint(offsets[at], offsets[at + 1], offsets[at + 2]),
                        {normals[at], normals[at + 1], normals[at + 2]}});
  }
  return vertices;
}

/// The edge of `tile` that lies against `other`. At level 0 and beyond, two tiles share one edge at most.
inline std::optional<Side> edgeTowards(const FacePath& tile, const FacePath& other) {
  for (int side = 0; side < kEdgeCount; ++side)
    if (tile.neighbour(static_cast<Side>(side)) == other) return static_cast<Side>(side);
  return std::nullopt;
}

inline void expectSameEdge(const Tile& tile, Side side, const Tile& neighbour) {
  const std::optional<Side> back = edgeTowards(neighbour.metadata.path, tile.metadata.path);
  ASSERT_TRUE(back.has_value());
  const std::vector<EdgeVertex> mine = edgeVertices(tile, side);
  std::vector<EdgeVertex> theirs = edgeVertices(neighbour, *back);
  if (!(theirs.front().point == mine.front().point)) std::reverse(theirs.begin(), theirs.end());
  ASSERT_EQ(tile.metadata.stepExponent, neighbour.metadata.stepExponent);
  EXPECT_EQ(mine, theirs) << tile.metadata.path.text() << " and " << neighbour.metadata.path.text();
}

}  // namespace terrane::testing_support

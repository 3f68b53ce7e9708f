#include "server/build/tile_topology.h"

#include <numeric>

#include "common/tiling/tile_neighbours.h"
#include "common/tiling/triangle_grid.h"
#include "proto/tile_mesh.h"

namespace terrane {
namespace {

void addSquareTriangles(std::uint32_t cells, std::vector<std::uint32_t>& triangles) {
  const std::uint32_t side = cells + 1;
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t v00 = j * side + i, v10 = v00 + 1, v01 = v00 + side, v11 = v01 + 1;
      triangles.insert(triangles.end(), {v00, v10, v11, v00, v11, v01});
    }
  }
}

std::vector<std::uint32_t> squareBoundary(std::uint32_t cells) {
  const std::uint32_t side = cells + 1;
  std::vector<std::uint32_t> anchors;
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back(k);                         // VMin, towards +u
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back(k * side + cells);          // UMax, towards +v
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back(cells * side + cells - k);  // VMax, towards -u
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back((cells - k) * side);        // UMin, towards -v
  return anchors;
}

/// Row by row; between each two triangles that lie as the tile does, one turned round.
void addTriangularTriangles(int cells, std::vector<std::uint32_t>& triangles) {
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(triangleGridIndex(cells, {i, j})); };
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i + j < cells; ++i) {
      triangles.insert(triangles.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < cells) triangles.insert(triangles.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
}

std::vector<std::uint32_t> triangularBoundary(int cells) {
  std::vector<std::uint32_t> anchors;
  for (int edge = 0; edge < edgeCount(Scheme::Ico); ++edge)
    for (int k = 0; k <= cells; ++k)
      anchors.push_back(static_cast<std::uint32_t>(triangleGridIndex(cells, edgeVertex(cells, edge, k))));
  return anchors;
}

/// A wall below each edge that faces away from the tile.
void addSkirtTriangles(std::uint32_t cells, std::uint32_t firstSkirt, const std::vector<std::uint32_t>& anchors,
                       std::vector<std::uint32_t>& triangles) {
  for (std::uint32_t start = 0; start < anchors.size(); start += cells + 1) {
    for (std::uint32_t at = start; at < start + cells; ++at) {
      const std::uint32_t top = anchors[at], nextTop = anchors[at + 1];
      const std::uint32_t bottom = firstSkirt + at, nextBottom = bottom + 1;
      triangles.insert(triangles.end(), {top, bottom, nextTop, nextTop, bottom, nextBottom});
    }
  }
}

}  // namespace

std::shared_ptr<const TileTopology> makeTileTopology(Scheme scheme, int cellsPerEdge) {
  const auto cells = static_cast<std::uint32_t>(cellsPerEdge);
  const std::size_t gridVertices = gridVertexCount(scheme, cellsPerEdge);
  auto topology = std::make_shared<TileTopology>();
  topology->cellsPerEdge = cellsPerEdge;
  if (scheme == Scheme::Cube) {
    topology->skirtAnchors = squareBoundary(cells);
    addSquareTriangles(cells, topology->triangles);
  } else {
    topology->skirtAnchors = triangularBoundary(cellsPerEdge);
    addTriangularTriangles(cellsPerEdge, topology->triangles);
  }
  addSkirtTriangles(cells, static_cast<std::uint32_t>(gridVertices), topology->skirtAnchors, topology->triangles);
  topology->gridIndices.resize(gridVertices + topology->skirtAnchors.size());
  std::iota(topology->gridIndices.begin(), topology->gridIndices.end(), std::uint16_t{0});
  return topology;
}

}  // namespace terrane

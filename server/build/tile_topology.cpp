#include "server/build/tile_topology.h"

#include <numeric>

namespace terrane {
namespace {

void addGridTriangles(std::uint32_t cells, std::vector<std::uint32_t>& triangles) {
  const std::uint32_t side = cells + 1;
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t v00 = j * side + i, v10 = v00 + 1, v01 = v00 + side, v11 = v01 + 1;
      triangles.insert(triangles.end(), {v00, v10, v11, v00, v11, v01});
    }
  }
}

std::vector<std::uint32_t> boundaryInSkirtOrder(std::uint32_t cells) {
  const std::uint32_t side = cells + 1;
  std::vector<std::uint32_t> anchors;
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back(k);                         // VMin, towards +u
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back(k * side + cells);          // UMax, towards +v
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back(cells * side + cells - k);  // VMax, towards -u
  for (std::uint32_t k = 0; k < side; ++k) anchors.push_back((cells - k) * side);        // UMin, towards -v
  return anchors;
}

/// A wall below each edge that faces away from the tile.
void addSkirtTriangles(std::uint32_t cells, const std::vector<std::uint32_t>& anchors,
                       std::vector<std::uint32_t>& triangles) {
  const std::uint32_t side = cells + 1, firstSkirt = side * side;
  for (std::uint32_t edge = 0; edge < 4; ++edge) {
    for (std::uint32_t k = 0; k < cells; ++k) {
      const std::uint32_t at = edge * side + k;
      const std::uint32_t top = anchors[at], nextTop = anchors[at + 1];
      const std::uint32_t bottom = firstSkirt + at, nextBottom = bottom + 1;
      triangles.insert(triangles.end(), {top, bottom, nextTop, nextTop, bottom, nextBottom});
    }
  }
}

}  // namespace

std::shared_ptr<const TileTopology> makeTileTopology(int cellsPerEdge) {
  const auto cells = static_cast<std::uint32_t>(cellsPerEdge);
  auto topology = std::make_shared<TileTopology>();
  topology->cellsPerEdge = cellsPerEdge;
  topology->skirtAnchors = boundaryInSkirtOrder(cells);
  addGridTriangles(cells, topology->triangles);
  addSkirtTriangles(cells, topology->skirtAnchors, topology->triangles);
  topology->gridIndices.resize((cells + 1) * (cells + 1) + topology->skirtAnchors.size());
  std::iota(topology->gridIndices.begin(), topology->gridIndices.end(), std::uint16_t{0});
  return topology;
}

}  // namespace terrane

#include "proto/resident_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace terrane {
namespace {

struct GridPlace {
  int i, j;
};

/// As the order of vertices says (tile_mesh.h); the middle of the grid, which touches all quarters, if it does not.
GridPlace placeOf(int grid, int cells) noexcept {
  const int side = cells + 1, skirt = grid - side * side;
  if (skirt < 0) return {grid % side, grid / side};
  const int along = skirt % side;
  switch (skirt / side) {
    case 0:
      return {along, 0};
    case 1:
      return {cells, along};
    case 2:
      return {cells - along, cells};
    case 3:
      return {0, cells - along};
    default:
      return {cells / 2, cells / 2};
  }
}

}  // namespace

std::array<HeightRange, 4> quarterHeights(const Tile& tile, double radiusMeters) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<HeightRange, 4> quarters;
  quarters.fill({kFar, -kFar});
  const int cells = tile.metadata.cellsPerEdge;
  const double step = stepMeters(tile.metadata.stepExponent);
  const glm::dvec3 origin = latticePosition(tile.metadata.origin, tile.metadata.stepExponent);
  for (std::size_t vertex = 0; vertex < tile.mesh.vertexCount(); ++vertex) {
    const std::uint16_t* offset = tile.mesh.offsets.data() + 3 * vertex;
    const double x = origin.x + offset[0] * step, y = origin.y + offset[1] * step, z = origin.z + offset[2] * step;
    const double height = std::sqrt(x * x + y * y + z * z) - radiusMeters;
    const GridPlace at = placeOf(tile.mesh.gridIndices[vertex], cells);
    for (int digit = 0; digit < 4; ++digit) {
      const bool overU = (digit & 1) != 0 ? 2 * at.i >= cells : 2 * at.i <= cells;
      const bool overV = (digit & 2) != 0 ? 2 * at.j >= cells : 2 * at.j <= cells;
      if (!overU || !overV) continue;
      HeightRange& range = quarters[static_cast<std::size_t>(digit)];
      range.minMeters = std::min(range.minMeters, height);
      range.maxMeters = std::max(range.maxMeters, height);
    }
  }
  return quarters;
}

ResidentTile residentTile(const Tile& tile, double radiusMeters) {
  return {tile.metadata.subtreeHeights, tile.metadata.heights, quarterHeights(tile, radiusMeters)};
}

}  // namespace terrane

#include "proto/resident_tile.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/tiling/triangle_grid.h"

namespace terrane {
namespace {

/// The child tiles that a vertex is over, a bit for each digit.
using Quarters = std::uint8_t;
constexpr Quarters kAllQuarters = 0xF;

Quarters quartersOfSquare(const GridVertex& at, int cells) noexcept {
  Quarters quarters = 0;
  for (int digit = 0; digit < 4; ++digit) {
    const bool overU = (digit & 1) != 0 ? 2 * at.i >= cells : 2 * at.i <= cells;
    const bool overV = (digit & 2) != 0 ? 2 * at.j >= cells : 2 * at.j <= cells;
    if (overU && overV) quarters = static_cast<Quarters>(quarters | 1 << digit);
  }
  return quarters;
}

Quarters quartersOfTriangle(const GridVertex& at, int cells) noexcept {
  const bool corner0 = 2 * (at.i + at.j) <= cells, corner1 = 2 * at.i >= cells, corner2 = 2 * at.j >= cells;
  const bool centre = 2 * (at.i + at.j) >= cells && 2 * at.i <= cells && 2 * at.j <= cells;
  return static_cast<Quarters>((corner0 ? 1 : 0) | (corner1 ? 2 : 0) | (corner2 ? 4 : 0) | (centre ? 8 : 0));
}

/// By grid index: the order of tile_mesh.h.
std::vector<Quarters> quartersOfSquares(int cells) {
  std::vector<Quarters> quarters;
  const auto add = [&](int i, int j) { quarters.push_back(quartersOfSquare({i, j}, cells)); };
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) add(i, j);
  for (int k = 0; k <= cells; ++k) add(k, 0);
  for (int k = 0; k <= cells; ++k) add(cells, k);
  for (int k = 0; k <= cells; ++k) add(cells - k, cells);
  for (int k = 0; k <= cells; ++k) add(0, cells - k);
  return quarters;
}
std::vector<Quarters> quartersOfTriangles(int cells) {
  std::vector<Quarters> quarters;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i + j <= cells; ++i) quarters.push_back(quartersOfTriangle({i, j}, cells));
  for (int edge = 0; edge < edgeCount(Scheme::Ico); ++edge)
    for (int k = 0; k <= cells; ++k) quarters.push_back(quartersOfTriangle(edgeVertex(cells, edge, k), cells));
  return quarters;
}

}  // namespace

std::array<HeightRange, 4> quarterHeights(const Tile& tile, double radiusMeters) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<HeightRange, 4> quarters;
  quarters.fill({kFar, -kFar});
  const int cells = tile.metadata.cellsPerEdge;
  const std::vector<Quarters> quartersOf =
      tile.metadata.path.scheme() == Scheme::Cube ? quartersOfSquares(cells) : quartersOfTriangles(cells);
  const double step = stepMeters(tile.metadata.stepExponent);
  const glm::dvec3 origin = latticePosition(tile.metadata.origin, tile.metadata.stepExponent);
  for (std::size_t vertex = 0; vertex < tile.mesh.vertexCount(); ++vertex) {
    const std::uint16_t* offset = tile.mesh.offsets.data() + 3 * vertex;
    const double x = origin.x + offset[0] * step, y = origin.y + offset[1] * step, z = origin.z + offset[2] * step;
    const double height = std::sqrt(x * x + y * y + z * z) - radiusMeters;
    const std::size_t grid = tile.mesh.gridIndices[vertex];
    const Quarters over = grid < quartersOf.size() ? quartersOf[grid] : kAllQuarters;
    for (std::size_t digit = 0; digit < quarters.size(); ++digit) {
      if ((over >> digit & 1) == 0) continue;
      HeightRange& range = quarters[digit];
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

#include <algorithm>
#include <vector>

#include "common/numerics/strict_math.h"
#include "server/fields/midpoint_gradient.h"
#include "server/fields/midpoint_samples.h"
#include "server/fields/midpoint_subdivision.h"

namespace terrane::midpoint {
namespace {

template <class Tiling>
void sampleGridOf(const Surface& surface, const GridPlace& grid, SurfaceSamples& out) {
  thread_local Subdivision<Tiling> subdivision;
  subdivision.start(surface.displacement, surface.gridLevel, grid.path.face(), 1);
  subdivision.enter(grid.path);
  while (subdivision.places().cells() < grid.cellsPerEdge) subdivision.halveCells();
  addDirections(subdivision);
  const Places& places = subdivision.places();
  const int cells = places.cells();
  std::size_t at = 0;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= Tiling::lastI(cells, j, 0); ++i, ++at) {
      const glm::dvec3 gradient = gradientAt<Tiling>(places, i, j, surface.radiusMeters);
      out.heightMeters[at] = places.at(i, j).heightMeters;
      out.gradientX[at] = static_cast<float>(gradient.x);
      out.gradientY[at] = static_cast<float>(gradient.y);
      out.gradientZ[at] = static_cast<float>(gradient.z);
    }
  }
}

template <class Tiling>
void sampleEdgeOf(const Surface& surface, const GridPlace& grid, std::span<double> out) {
  thread_local Subdivision<Tiling> subdivision;
  thread_local std::vector<double> heights;
  heights.resize(static_cast<std::size_t>(grid.cellsPerEdge) + 1);
  subdivision.start(surface.displacement, surface.gridLevel, grid.path.face(), 0);
  subdivision.enter(grid.path);
  const auto end = [&](int k) {
    const GridVertex corner = Tiling::edgePlace(1, grid.skirtEdge, k);
    return subdivision.places().at(corner.i, corner.j).heightMeters;
  };
  heights.front() = end(0);
  heights.back() = end(1);
  int gridLevel = subdivision.gridLevel();
  for (int cells = 2; cells <= grid.cellsPerEdge; cells *= 2) {
    ++gridLevel;
    const auto step = static_cast<std::size_t>(grid.cellsPerEdge / cells);
    for (int k = 1; k < cells; k += 2) {
      const std::size_t at = static_cast<std::size_t>(k) * step;
      heights[at] = 0.5 * (heights[at - step] + heights[at + step]);
      if (gridLevel > surface.gridLevel) continue;
      const GridVertex place = Tiling::edgePlace(cells, grid.skirtEdge, k);
      heights[at] +=
          surface.displacement.meters(gridLevel, subdivision.tiling().key(cells, gridLevel, place.i, place.j));
    }
  }
  std::copy_n(heights.begin(), out.size(), out.begin());
}

}  // namespace

void sampleGrid(const Surface& surface, const GridPlace& grid, SurfaceSamples& out) {
  if (grid.path.scheme() == Scheme::Ico) return sampleGridOf<IcoTiling<true>>(surface, grid, out);
  sampleGridOf<CubeTiling>(surface, grid, out);
}

void sampleEdge(const Surface& surface, const GridPlace& grid, std::span<double> heightMeters) {
  if (grid.path.scheme() == Scheme::Ico) return sampleEdgeOf<IcoTiling<false>>(surface, grid, heightMeters);
  sampleEdgeOf<CubeTiling>(surface, grid, heightMeters);
}

}  // namespace terrane::midpoint

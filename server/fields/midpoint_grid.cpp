#include <array>
#include <tuple>

#include "common/numerics/strict_math.h"
#include "server/fields/midpoint_samples.h"
#include "server/fields/midpoint_subdivision.h"

namespace terrane::midpoint {
namespace {

bool before(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// The vertices beside one, each once, counter-clockwise from the one with the least direction on. Before the first
/// stands the last, and after the last the first.
template <class Tiling>
class Neighbours {
 public:
  Neighbours(const Places& places, int i, int j) noexcept {
    std::array<const Vertex*, Tiling::kNeighbours> around{};
    std::size_t least = 0;
    for (const GridVertex& step : Tiling::kBeside) {
      const Vertex* vertex = &places.at(i + step.i, j + step.j);
      // Beside a corner of the solid two places, next to each other, are one vertex.
      if (count_ > 0 && around[count_ - 1]->direction == vertex->direction) continue;
      if (count_ > 0 && before(vertex->direction, around[least]->direction)) least = count_;
      around[count_++] = vertex;
    }
    if (around[count_ - 1]->direction == around[0]->direction) --count_;
    for (std::size_t k = 0; k < count_ + 2; ++k) {
      const std::size_t at = least + k + count_ - 1;
      ordered_[k] = around[at >= 2 * count_ ? at - 2 * count_ : at >= count_ ? at - count_ : at];
    }
  }
  std::size_t count() const noexcept { return count_; }
  /// 0 .. count + 1.
  const Vertex& operator[](std::size_t k) const noexcept { return *ordered_[k]; }

 private:
  std::array<const Vertex*, Tiling::kNeighbours + 2> ordered_{};
  std::size_t count_ = 0;
};

template <class Tiling>
glm::dvec3 gradientAt(const Places& places, int i, int j, double radiusMeters) noexcept {
  const Vertex& here = places.at(i, j);
  const Neighbours<Tiling> beside(places, i, j);
  glm::dvec3 turned(0.0), area(0.0);
  for (std::size_t k = 1; k <= beside.count(); ++k) {
    const Vertex &last = beside[k - 1], &now = beside[k], &next = beside[k + 1];
    turned += (next.direction - last.direction) * (now.heightMeters - here.heightMeters);
    area += cross(now.direction - here.direction, next.direction - here.direction);
  }
  return cross(turned, here.direction) / (radiusMeters * dot(area, here.direction));
}

/// Only the cube's: the icosahedron's come on the way.
void addDirections(Subdivision<CubeTiling>& subdivision) {
  Places& places = subdivision.places();
  const int cells = places.cells(), gridLevel = subdivision.gridLevel();
  subdivision.forEachPlace(cells, [&](int i, int j) {
    places.at(i, j).direction = CubeTiling::directionOf(subdivision.tiling().key(cells, gridLevel, i, j), gridLevel);
  });
}
void addDirections(Subdivision<IcoTiling<true>>&) noexcept {}

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
void sampleEdgeOf(const Surface& surface, const GridPlace& grid, std::span<double> heights) {
  thread_local Subdivision<Tiling> subdivision;
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

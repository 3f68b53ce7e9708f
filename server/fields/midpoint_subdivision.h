#pragma once
// From a whole face down to a tile and on to its grid, in memory of the tile's size alone. On the way down only the
// tile's corners are kept, with margin 1 the ring around them too: those of a child lie on or between its parent's.
// Belongs to one thread; start() keeps the memory.

#include <utility>
#include <vector>

#include "server/fields/midpoint_tilings.h"

namespace terrane::midpoint {

/// Vertices by place.
class Places {
 public:
  void resize(int cells) {
    cells_ = cells;
    vertices_.resize(static_cast<std::size_t>((cells + 3) * (cells + 3)));
  }
  int cells() const noexcept { return cells_; }
  Vertex& at(int i, int j) noexcept { return vertices_[index(i, j)]; }
  const Vertex& at(int i, int j) const noexcept { return vertices_[index(i, j)]; }

 private:
  std::size_t index(int i, int j) const noexcept { return static_cast<std::size_t>((j + 1) * (cells_ + 3) + (i + 1)); }
  int cells_ = 0;
  std::vector<Vertex> vertices_;
};

template <class Tiling>
class Subdivision {
 public:
  /// finestGridLevel: nothing is moved at finer levels. margin: 0, or 1 for the ring too.
  void start(const MidpointDisplacement& displacement, int finestGridLevel, int face, int margin) {
    displacement_ = &displacement;
    finest_ = finestGridLevel;
    margin_ = margin;
    tiling_ = Tiling(face);
    gridLevel_ = 0;
    places_.resize(1);
    forEachPlace(1, [&](int i, int j) {
      Vertex corner = tiling_.corner(i, j);
      corner.heightMeters = moved(i, j);
      places_.at(i, j) = corner;
    });
  }

  /// Precondition: one cell.
  void enterChild(int digit) {
    tiling_.enterChild(digit);
    refine(Tiling::childPlace(digit), 1);
  }
  void enter(const FacePath& path) {
    for (int i = 0; i < path.level(); ++i) enterChild(path.digit(i));
  }
  void halveCells() { refine({}, 2 * places_.cells()); }

  int gridLevel() const noexcept { return gridLevel_; }
  const Tiling& tiling() const noexcept { return tiling_; }
  Places& places() noexcept { return places_; }

  template <class Do>
  void forEachPlace(int cells, Do&& visit) const {
    for (int j = -margin_; j <= cells + margin_; ++j)
      for (int i = Tiling::firstI(cells, j, margin_); i <= Tiling::lastI(cells, j, margin_); ++i) visit(i, j);
  }

  /// How far the vertex at a place that is new at this grid level is moved; (i, j) of the tile with so many cells.
  double moved(int i, int j) const noexcept {
    if (gridLevel_ > finest_) return 0;
    return displacement_->meters(gridLevel_, tiling_.key(places_.cells(), gridLevel_, i, j));
  }

 private:
  void refine(const ChildPlace& from, int cells) {
    ++gridLevel_;
    std::swap(places_, coarse_);
    places_.resize(cells);
    forEachPlace(cells, [&](int i, int j) {
      const int half = from.i + from.sign * i, halfJ = from.j + from.sign * j;
      if (((half | halfJ) & 1) == 0) {
        places_.at(i, j) = coarse_.at(half / 2, halfJ / 2);
        return;
      }
      Vertex vertex = Tiling::between(coarse_, half, halfJ);
      vertex.heightMeters += moved(i, j);
      places_.at(i, j) = vertex;
    });
  }

  const MidpointDisplacement* displacement_ = nullptr;
  Tiling tiling_{0};
  int finest_ = 0, margin_ = 0, gridLevel_ = 0;
  Places places_, coarse_;
};

/// Of all places: the cube's, from their keys. The icosahedron's came on the way.
inline void addDirections(Subdivision<CubeTiling>& subdivision) {
  Places& places = subdivision.places();
  const int cells = places.cells(), gridLevel = subdivision.gridLevel();
  subdivision.forEachPlace(cells, [&](int i, int j) {
    places.at(i, j).direction = CubeTiling::directionOf(subdivision.tiling().key(cells, gridLevel, i, j), gridLevel);
  });
}
inline void addDirections(Subdivision<IcoTiling<true>>&) noexcept {}

}  // namespace terrane::midpoint

#pragma once
// The tiles of one level that touch a tile, by one interface for both schemes, over face edges and corners too. Edges
// and corners are counted from 0: those of a cube tile in the order of Side (UMin, UMax, VMin, VMax; UMinVMin,
// UMaxVMin, UMinVMax, UMaxVMax), those of an ico tile as in triangle_tile.h. Integers alone; thread-safe.

#include <array>
#include <cstddef>
#include <span>

#include "common/tiling/face_path.h"

namespace terrane {

/// Of a tile; it has as many corners.
constexpr int edgeCount(Scheme scheme) noexcept { return scheme == Scheme::Cube ? 4 : 3; }
/// Of any scheme.
inline constexpr int kMostEdges = 4;

/// Tiles by value, in a fixed order.
class TileList {
 public:
  static constexpr std::size_t kMost = 12;  ///< around an ico tile

  std::span<const FacePath> tiles() const noexcept { return std::span(tiles_).first(count_); }
  const FacePath* begin() const noexcept { return tiles_.data(); }
  const FacePath* end() const noexcept { return tiles_.data() + count_; }
  void add(const FacePath& tile) noexcept { tiles_[count_++] = tile; }

 private:
  std::array<FacePath, kMost> tiles_{};
  std::size_t count_ = 0;
};

/// The tile beyond an edge: there always is one.
FacePath tileBeyondEdge(const FacePath& path, int edge) noexcept;
/// All other tiles that have a corner: three of a cube tile, two at a corner of the cube; five of an ico tile, four at
/// a vertex of the icosahedron.
TileList tilesAtCorner(const FacePath& path, int corner) noexcept;
/// All other tiles that have one of its corners, each once.
TileList tilesAround(const FacePath& path) noexcept;

}  // namespace terrane

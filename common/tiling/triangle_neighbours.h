#pragma once
// The tiles of the `ico` scheme that share an edge or a corner with a tile, all of the tile's level, over the edges and
// vertices of the icosahedron too. Integers alone; thread-safe. Corners and edges as in triangle_tile.h.

#include <array>
#include <span>

#include "common/tiling/face_path.h"

namespace terrane {

/// A tile by one of its edges. The edge is seen from the other side: it runs the other way, its first end being
/// the tile's second. Within a face it has the same number in both tiles.
struct TileEdge {
  FacePath tile;
  int edge = 0;
  bool operator==(const TileEdge&) const = default;
};
/// The tile beyond edge 0, 1 or 2: there always is one. Precondition: path is of the scheme Ico.
TileEdge beyondEdge(const FacePath& path, int edge) noexcept;

/// A tile by one of its corners.
struct TileCorner {
  FacePath tile;
  int corner = 0;
  bool operator==(const TileCorner&) const = default;
};
/// Six tiles, or five around a vertex of the icosahedron.
class TilesAroundCorner {
 public:
  std::span<const TileCorner> tiles() const noexcept { return std::span(tiles_).first(count_); }

 private:
  friend TilesAroundCorner tilesAroundCorner(const FacePath& path, int corner) noexcept;
  std::array<TileCorner, 6> tiles_{};
  std::size_t count_ = 0;
};
/// All tiles that have the corner, counter-clockwise seen from outside, the tile itself first. The second lies beyond
/// the tile's edge corner + 1, the last beyond its edge corner + 2 (mod 3). Precondition: path is of the scheme Ico.
TilesAroundCorner tilesAroundCorner(const FacePath& path, int corner) noexcept;

}  // namespace terrane

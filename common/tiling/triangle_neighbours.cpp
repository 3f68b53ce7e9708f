#include "common/tiling/triangle_neighbours.h"

#include "common/tiling/triangle_tile.h"

namespace terrane {
namespace {

/// As TileEdge, by integers.
struct TriangleEdge {
  TriangleTile tile;
  int edge;
};

TriangleEdge beyond(const TriangleTile& tile, int edge) noexcept {
  const int first = (edge + 1) % kTriangleCorners, second = (edge + 2) % kTriangleCorners;
  if (tile.sign > 0 && tile.base[edge] == 0) {
    // The edge lies along the face's. The tile beyond is upright too, and the weights at the ends of the face's edge
    // change places, as it is run along the other way.
    const FaceEdge other = beyondFaceEdge(tile.face, edge);
    TriangleTile there{.face = other.face, .level = tile.level};
    there.base[(other.edge + 1) % kTriangleCorners] = tile.base[second];
    there.base[(other.edge + 2) % kTriangleCorners] = tile.base[first];
    return {there, other.edge};
  }
  // The same edge of a tile turned round: its corners first and second are the tile's second and first.
  TriangleTile there = tile;
  there.sign = -tile.sign;
  there.base[first] += tile.sign;
  there.base[second] += tile.sign;
  return {there, edge};
}

}  // namespace

TileEdge beyondEdge(const FacePath& path, int edge) noexcept {
  const TriangleEdge there = beyond(triangleTile(path), edge);
  return {pathOf(there.tile), there.edge};
}

TilesAroundCorner tilesAroundCorner(const FacePath& path, int corner) noexcept {
  TilesAroundCorner around;
  const TriangleTile start = triangleTile(path);
  TriangleTile tile = start;
  do {
    around.tiles_[around.count_++] = {pathOf(tile), corner};
    // The edge that ends in the corner begins there for the tile beyond.
    const TriangleEdge next = beyond(tile, (corner + 1) % kTriangleCorners);
    tile = next.tile;
    corner = (next.edge + 1) % kTriangleCorners;
  } while (!(tile == start));
  return around;
}

}  // namespace terrane

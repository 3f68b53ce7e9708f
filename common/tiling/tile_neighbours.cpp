#include "common/tiling/tile_neighbours.h"

#include "common/tiling/triangle_neighbours.h"

namespace terrane {
namespace {

/// The two edges that meet in each corner of a cube tile.
constexpr std::array<std::array<Side, 2>, 4> kEdgesOfCorner{
    {{Side::UMin, Side::VMin}, {Side::UMax, Side::VMin}, {Side::UMin, Side::VMax}, {Side::UMax, Side::VMax}}};

void addBeyond(const FacePath& path, Side side, TileList& list) noexcept {
  if (const auto tile = path.neighbour(side)) list.add(*tile);
}

}  // namespace

FacePath tileBeyondEdge(const FacePath& path, int edge) noexcept {
  return path.scheme() == Scheme::Cube ? *path.neighbour(static_cast<Side>(edge)) : beyondEdge(path, edge).tile;
}

TileList tilesAtCorner(const FacePath& path, int corner) noexcept {
  TileList list;
  if (path.scheme() == Scheme::Cube) {
    for (const Side edge : kEdgesOfCorner[static_cast<std::size_t>(corner)]) addBeyond(path, edge, list);
    addBeyond(path, static_cast<Side>(kEdgeCount + corner), list);
    return list;
  }
  const TilesAroundCorner around = tilesAroundCorner(path, corner);
  for (const TileCorner& tile : around.tiles().subspan(1)) list.add(tile.tile);
  return list;
}

TileList tilesAround(const FacePath& path) noexcept {
  TileList list;
  if (path.scheme() == Scheme::Cube) {
    for (int side = 0; side < kSideCount; ++side) addBeyond(path, static_cast<Side>(side), list);
    return list;
  }
  // The last tile around a corner is the first around the next.
  for (int corner = 0; corner < edgeCount(path.scheme()); ++corner) {
    const TilesAroundCorner around = tilesAroundCorner(path, corner);
    const auto tiles = around.tiles();
    for (const TileCorner& tile : tiles.subspan(1, tiles.size() - 2)) list.add(tile.tile);
  }
  return list;
}

}  // namespace terrane

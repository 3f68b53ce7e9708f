#include "tests/accuracy/projection/tile_costs.h"

#include "common/tiling/ico_sphere.h"
#include "server/build/grid_directions.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/support/require.h"

namespace terrane::accuracy {
namespace {

constexpr std::array<int, 4> kLevels{4, 10, 16, 20};

std::vector<FacePath> tilesOf(Scheme scheme, const std::vector<Place>& places) {
  std::vector<FacePath> tiles;
  for (const Place& place : places)
    for (const int level : kLevels) tiles.push_back(tileAt(scheme, place.direction, level));
  return tiles;
}

Work builds(const TileBuilder& builder, const std::vector<FacePath>& tiles) {
  return [&builder, &tiles](std::size_t count) {
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < count; ++i) bytes += require(builder.build(tiles[i % tiles.size()])).glb.size();
    return static_cast<double>(bytes);
  };
}

Work cubeDirections(const std::vector<FacePath>& tiles, int cells) {
  return [&tiles, cells, directions = GridDirections()](std::size_t count) mutable {
    for (std::size_t i = 0; i < count; ++i) gridDirections(tiles[i % tiles.size()], cells, directions);
    return directions.x.back();
  };
}

Work icoDirections(IcoMap map, const std::vector<FacePath>& tiles, int cells) {
  const std::vector<double> axis(static_cast<std::size_t>(triangleGridSize(cells)));
  return [map, &tiles, cells, x = axis, y = axis, z = axis](std::size_t count) mutable {
    for (std::size_t i = 0; i < count; ++i) icoGridDirections(map, tiles[i % tiles.size()], cells, {x, y, z});
    return x.back();
  };
}

}  // namespace

AllTileCosts tileCosts(const TileBuilder& cube, const TileBuilder& ico, const std::vector<Place>& places, int rounds) {
  const std::vector<FacePath> cubeTiles = tilesOf(Scheme::Cube, places), icoTiles = tilesOf(Scheme::Ico, places);
  const int cubeCells = cube.info().cellsPerEdge, icoCells = ico.info().cellsPerEdge;
  const std::vector<double> ns = nanosecondsPerItem(
      {builds(cube, cubeTiles), builds(ico, icoTiles), cubeDirections(cubeTiles, cubeCells),
       icoDirections(IcoMap::Bisected, icoTiles, icoCells), icoDirections(IcoMap::Gnomonic, icoTiles, icoCells)},
      cubeTiles.size(), rounds);
  const std::size_t square = gridVertexCount(Scheme::Cube, cubeCells),
                    triangle = gridVertexCount(Scheme::Ico, icoCells);
  const auto perVertex = [](double nsPerTile, std::size_t vertices) {
    return nsPerTile / static_cast<double>(vertices);
  };
  return {{square, perVertex(ns[2], square), ns[0] * 1e-6},
          {triangle, perVertex(ns[3], triangle), ns[1] * 1e-6},
          {triangle, perVertex(ns[4], triangle), 0}};
}

}  // namespace terrane::accuracy

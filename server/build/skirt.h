#pragma once
// How far down the skirts of a tile hang: to just below the lowest edge that may ever be drawn against it. Beside a
// tile lies one of its own level (the same edge), of the next coarser or of the next finer one (the drawn set is 2:1
// balanced); both their edges follow from the field, so that the depth is exact and short, vertex by vertex, instead of
// a worst case. Each side of a border covers what it stands above: where two straight edges differ, the higher one's
// skirt reaches below the lower one everywhere, because at every vertex of either it does. Heights in metres above the
// reference sphere, body frame. Thread-safe.

#include <vector>

#include "common/tiling/face_path.h"
#include "server/build/grid_directions.h"
#include "server/build/level_accuracy.h"
#include "server/build/tile_topology.h"
#include "server/fields/height_field.h"

namespace terrane {

/// Memory that is kept between tiles.
struct SkirtScratch {
  GridDirections directions;
  SurfaceSamples samples;
  std::vector<double> heightMeters;  ///< of all edges
};

struct SkirtInput {
  const HeightField& field;
  const std::vector<LevelAccuracy>& levels;
  const TileTopology& topology;
  double radiusMeters;
  FacePath path;
  const GridDirections& directions;         ///< of the tile's grid
  const std::vector<double>& heightMeters;  ///< of the tile's grid
};

/// The height of each skirt vertex' lower end, in the order of topology.skirtAnchors. Precondition: an even number of
/// cells.
void skirtHeights(const SkirtInput& tile, SkirtScratch& scratch, std::vector<double>& out);

}  // namespace terrane

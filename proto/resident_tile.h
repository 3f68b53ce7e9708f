#pragma once
// What selection remembers of a tile: heights of its subtree, of its mesh, and of each quarter of its mesh.

#include <array>

#include "common/view/tile_selection.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// Heights above a sphere of radiusMeters of all vertices over the child `digit`, for each digit; error <= 4 ulp of the
/// radius. A vertex on the line between two quarters counts for both. Vertices whose grid index says nothing count for
/// all four. Thread-safe.
std::array<HeightRange, 4> quarterHeights(const Tile& tile, double radiusMeters);

/// As of a tile that may be drawn.
ResidentTile residentTile(const Tile& tile, double radiusMeters);

}  // namespace terrane

#pragma once
// What a tile costs to build by each map, and what of it goes into the directions of its grid: taken in turn.

#include <array>
#include <cstdint>

#include "tests/accuracy/projection/descent.h"

namespace terrane::accuracy {

struct TileCosts {
  std::size_t gridVertices = 0;  ///< of a tile, without skirts
  double directionsNs = 0;       ///< a vertex of the grid
  double buildMs = 0;            ///< a tile, ground to GLB; 0 of a map by which no tiles are served

  double buildNsPerVertex() const { return buildMs * 1e6 / static_cast<double>(gridVertices); }
};

struct AllTileCosts {
  TileCosts cube, bisected, gnomonic;
};

/// Medians over `rounds` of the same places at several levels.
AllTileCosts tileCosts(const TileBuilder& cube, const TileBuilder& ico, const std::vector<Place>& places, int rounds);

}  // namespace terrane::accuracy

#pragma once
// Unit directions of all grid vertices of a tile at once, body frame. Bit for bit what cubeGridDirection or, by the map
// that tiles are served by, icoGridDirection gives for each (grid_directions_test). Thread-safe.

#include <vector>

#include "common/tiling/face_path.h"

namespace terrane {

/// Structure of arrays, in the order of grid indices (tile_topology.h).
struct GridDirections {
  std::vector<double> x, y, z;
};

/// Fills out, keeping its memory. Precondition: cellsPerEdge a power of two.
void gridDirections(const FacePath& path, int cellsPerEdge, GridDirections& out);

/// Appends the directions of the cellsPerEdge + 1 vertices along an edge of such a grid: edges and vertices in the
/// order of the skirts (tile_topology.h).
void appendEdgeDirections(const FacePath& path, int skirtEdge, int cellsPerEdge, GridDirections& out);

}  // namespace terrane

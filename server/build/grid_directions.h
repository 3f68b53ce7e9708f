#pragma once
// Unit directions of all grid vertices of a tile at once, body frame. Bit for bit what cubeGridDirection gives for each
// (grid_directions_test): two tangents for each line of the grid serve all its vertices. Thread-safe.

#include <vector>

#include "common/tiling/face_path.h"

namespace terrane {

/// Structure of arrays; vertex (i, j) is at j * (cells + 1) + i, i along u.
struct GridDirections {
  std::vector<double> x, y, z;
};

/// Fills out, keeping its memory. Preconditions: cube tile, cellsPerEdge a power of two.
void gridDirections(const FacePath& path, int cellsPerEdge, GridDirections& out);

}  // namespace terrane

#pragma once
// For tests of tiles that morph: parents of every kind, and where their meshes lie.

#include "common/tiling/face_path.h"
#include "common/tiling/lattice.h"
#include "proto/tile_mesh.h"

#include <cstdint>
#include <random>

namespace terrane {

/// The parent number `round` of a test. Levels from 0, so that children reach the Moon's finest, 30 or 29, one after
/// another; by 30 rounds inside, at edges and at corners of every face are among them, by 720 (cube) all of these at
/// every level. random: where exactly.
FacePath parentOf(Scheme scheme, std::mt19937_64& random, int round);
constexpr int parentLevels(Scheme scheme) { return scheme == Scheme::Cube ? 30 : 29; }

/// Vertex (i, j) of a complete grid whose vertices lie in grid order, in steps.
LatticePoint latticePoint(const Tile& tile, int i, int j);

/// Twice the point of the mesh at half-cell (x, y), from the triangle that it lies in.
LatticePoint twiceMeshPoint(const Tile& tile, int x, int y);

}  // namespace terrane

#pragma once
// The icosahedral sphere: points of the `ico` scheme's triangular faces to unit directions in the body frame, and back,
// by either of two maps.
//   Bisected: each vertex of a grid is the normalised middle of an edge of the grid of half as many cells (Baumgardner
//   and Frederickson 1985, "Icosahedral discretization of the two-sphere"). The largest tile of a level has 1.30 times
//   the area of the smallest (ico_shapes_test).
//   Gnomonic: the point of the flat face, normalised. Straight lines of a face become great circles. The largest tile
//   has up to 1.99 times the area of the smallest: the inradius to the power of -3.
// By both maps the edges of a tile are arcs of great circles, so that a tile is the spherical triangle of its corners
// and holds all its descendants; and a tile's grid holds the grid of its parent to the bit.
//
// Deterministic: only + - x / sqrt in double, no libm. All tiles and faces that share a point compute the very same
// bits for it. Bisected: the edge in whose middle a vertex lies is the same for all of them, a sum of two does not
// depend on their order, and norms are summed in world axis order. Gnomonic: on the edge between two faces the third
// weight is 0, which leaves a sum of two. Thread-safe.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "common/tiling/face_path.h"
#include "common/tiling/triangle_tile.h"

namespace terrane {

enum class IcoMap : std::uint8_t { Bisected, Gnomonic };
/// Tiles are served by this one: its cells are more alike.
inline constexpr IcoMap kIcoMap = IcoMap::Bisected;

/// The longest edge of a tile, in nominal widths of its level (atan 2 / 2^level), by either map (ico_shapes_test).
inline constexpr double kIcoLongestEdge = 1.2;

/// How far a component of a computed direction may be from the exact map's; proofs in ico_sphere.cpp
/// (ico_sphere_test). At grid level 36, of 64 cells at level 30: 9.1e-15 and 1.2e-15 of the radius, where the lattice's
/// step is 3.1e-14 or more.
constexpr double icoDirectionError(IcoMap map, int gridLevel) noexcept {
  return map == IcoMap::Gnomonic ? 11 * 0x1p-53 : (2 * gridLevel + 10) * 0x1p-53;
}

/// The unit direction of a point of a face (weights as in triangle_tile.h). Bisected: about gridLevel steps of three
/// square roots. Precondition: 0 <= gridLevel <= 52.
glm::dvec3 icoGridDirection(IcoMap map, int face, int gridLevel, const FaceWeights& weights) noexcept;

/// The unit directions of a tile's corners 0, 1, 2. Precondition: path is of the scheme Ico.
std::array<glm::dvec3, kTriangleCorners> icoCornerDirections(IcoMap map, const FacePath& path) noexcept;

/// By triangleGridIndex; each of triangleGridSize(cells).
struct DirectionSpans {
  std::span<double> x, y, z;
};
/// The unit directions of all vertices of a tile's grid: bit for bit those of icoGridDirection, at the cost of one
/// square root each. Precondition: path is of the scheme Ico.
void icoGridDirections(IcoMap map, const FacePath& path, int cells, const DirectionSpans& out) noexcept;

/// The unit directions along edge 0, 1 or 2 of such a grid, in the order of edgeVertex; each of cells + 1. The same
/// bits again, without the grid. Preconditions: path is of the scheme Ico, cells a power of two.
void icoEdgeDirections(IcoMap map, const FacePath& path, int edge, int cells, const DirectionSpans& out) noexcept;

/// The tile of a level, at most FacePath::kMaxLevel, that holds a direction: any finite non-zero vector of any length.
/// Faces as icosahedronFaceAt has them; below, a direction on the border between a corner child and the centre child is
/// the centre child's. Borders are where the arithmetic sees them: the tile may end kIcoTileAtError radians short of
/// the direction.
FacePath icoTileAt(IcoMap map, const glm::dvec3& direction, int level) noexcept;
inline constexpr double kIcoTileAtError = 2.5e-14;

}  // namespace terrane

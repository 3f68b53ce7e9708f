#pragma once
// Bounding volumes of a tile of either scheme as a pure function of (path, radius, height range), so that server,
// client and tests agree, and a tile that nobody has built yet can be culled by its parent's subtree height range.
// Every volume contains all surface points of the tile's footprint with heights in the range, the lattice points that
// they are rounded to, and every chord between them (a mesh sags below the sphere it samples); so do the volumes of its
// ancestors. The proofs are in tile_bounds.cpp. Body frame, metres. Thread-safe.

#include <array>
#include <glm/vec3.hpp>

#include "common/tiling/face_path.h"

namespace terrane {

/// Heights above the reference sphere, metres.
struct HeightRange {
  double minMeters = 0;
  double maxMeters = 0;
};

struct Sphere {
  glm::dvec3 center{0.0};
  double radiusMeters = 0;
};

/// An oriented box: centre and three half-axis vectors (metres), as 3D Tiles' "box".
struct OrientedBox {
  glm::dvec3 center{0.0};
  std::array<glm::dvec3, 3> halfAxes{};
};

/// The lower ends of skirts lean outwards by this many lattice steps, so that the hairline which rasterisation may
/// leave along a border of two levels is closed also when one looks straight down it. Bounds make room for them.
inline constexpr double kSkirtFlareSteps = 2.0;
/// At a tile's corners two skirts share their lowest point, so that no wedge opens between them: both lean that far out
/// of their planes there, which is up to this far along the mitre. Edges of a cube tile meet at 60 degrees and more,
/// those of an ico tile at 54 (ico_shapes_test): 1 / sin 27 degrees = 2.203.
constexpr double skirtCornerFlareSteps(Scheme scheme) noexcept {
  return (scheme == Scheme::Cube ? 2.0 : 2.203) * kSkirtFlareSteps;
}

struct TileBounds {
  /// The tile lies within the convex hull of these: corners (u, v) = 00 10 01 11 of the inner face, then of the outer
  /// face. The side faces are great-circle planes, as the tile's own edges are. An ico tile has three corners;
  /// the third stands for the fourth too.
  std::array<glm::dvec3, 8> hull{};
  OrientedBox box;
  Sphere sphere;
  /// The whole tile is below the horizon of the occluder sphere if this point is (Ring 2013, "Horizon culling"); body
  /// frame, metres. Not finite (NaN) when the tile is too large for such a point to exist: then the test must be
  /// skipped.
  glm::dvec3 horizonPoint{0.0};
};

/// occluderRadiusMeters: a sphere that the drawn surface never leaves open (lowestSurfaceRadiusMeters below).
TileBounds tileBounds(const FacePath& path, double radiusMeters, const HeightRange& heights,
                      double occluderRadiusMeters) noexcept;

/// The same for a quarter of a tile's own mesh, the part over its child `digit`: vertices lie on the tile's lattice,
/// not the child's. Precondition: path.level() < FacePath::kMaxLevel.
TileBounds tileQuarterBounds(const FacePath& path, int digit, double radiusMeters, const HeightRange& heights,
                             double occluderRadiusMeters) noexcept;

/// The radius of a sphere that no triangle of any drawn tile dips below, given the lowest height of the body and the
/// number of cells on a tile's edge: (R + min) times the cosine of half the diagonal of a level-0 cell.
double lowestSurfaceRadiusMeters(double radiusMeters, double lowestHeightMeters, int cellsPerEdge,
                                 Scheme scheme = Scheme::Cube) noexcept;

}  // namespace terrane

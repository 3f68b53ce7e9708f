#pragma once
// The lattice: every vertex of every tile of one level is rounded to integer multiples of one step, a power of two
// metres, in the body frame. Two tiles that share a vertex then store the very same integers, over face edges and
// corners too.
//   step = 2^ceil(log2(W / 2^15)),  W = the tile's nominal width: the angle along an edge of a whole face, pi/2 for the
//   cube and atan 2 for the icosahedron, times R / 2^level.
// A tile stores offsets 0..65535 from its own origin, which is a lattice point too. Thread-safe, no failure.

#include <cstdint>
#include <glm/vec3.hpp>

#include "common/numerics/strict_math.h"
#include "common/tiling/face_path.h"

namespace terrane {

/// An exact body-frame position in units of a level's step.
using LatticePoint = glm::i64vec3;

/// No step below this: a 3D Tiles client loses its shading where a matrix determinant falls under 10^-21.
inline constexpr int kMinStepExponent = -23;
inline constexpr int kTileOffsetMax = 65535;
/// Body radii that the lattice serves, metres: an asteroid of 250 m to the Sun.
inline constexpr double kMinRadiusMeters = 250.0;
inline constexpr double kMaxRadiusMeters = 7.0e8;

/// W above.
double nominalTileWidthMeters(double radiusMeters, int level, Scheme scheme = Scheme::Cube) noexcept;

/// step = 2^exponent metres, exactly as defined above (no logarithm is taken, so no last bit can differ).
int stepExponent(double radiusMeters, int level, Scheme scheme = Scheme::Cube) noexcept;
double stepMeters(int stepExponent) noexcept;

/// The finest level whose step is >= 2^kMinStepExponent metres, at most FacePath::kMaxLevel.
int maxLevel(double radiusMeters, Scheme scheme = Scheme::Cube) noexcept;

/// Nearest whole number, halves up. Precondition: |x| < 2^51. Inline and without an integer or a branch, so that loops
/// become vector instructions even on the oldest x86-64.
inline double roundedHalfUp(double x) noexcept {
  constexpr double kWhole = 6755399441055744.0;  // 1.5 x 2^52: a sum with it is whole, rounded to the nearest
  const double nearest = (x + kWhole) - kWhole;
  // The difference is exact. It is a half where a half went down, to the even neighbour.
  return nearest + (x - nearest >= 0.5 ? 1.0 : 0.0);
}

/// Nearest lattice point, halves up. Precondition: |position| / step < 2^51.
LatticePoint roundToLattice(const glm::dvec3& positionBody, int stepExponent) noexcept;

/// Exact whenever the coordinates are below 2^53.
glm::dvec3 latticePosition(const LatticePoint& point, int stepExponent) noexcept;

}  // namespace terrane

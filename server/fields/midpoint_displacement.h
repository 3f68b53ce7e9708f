#pragma once
// Recursive midpoint displacement (Fournier, Fussell, Carpenter 1982, "Computer rendering of stochastic models"), as
// numbers: how far each vertex of a grid is moved when it first appears, and what follows from it for all levels.
//
// A vertex that is new at grid level l, in the middle of an edge (or of a square) of the grid of level l - 1, has
//   height = mean of the two (four) vertices that it lies between + D(l) noise,   D(l) = amplitude 2^-l l^regularity,
// noise in [-1, 1) from a hash of the vertex itself, and keeps it at all finer levels. At level 0 the corners of the
// solid have amplitude times noise. At regularity 0 slopes grow little towards small scales, as those of Brownian
// ground do; the larger it is, the rougher is fine detail beside coarse.
//
// Metres. Deterministic: + - x / sqrt and integers alone, no libm. Immutable after construction, thread-safe.

#include <array>
#include <cstdint>

#include "common/tiling/face_path.h"

namespace terrane {

/// A vertex by what does not depend on the face or the tile it is seen from; two vertices of one scheme that are new at
/// the same grid level never share it (midpoint_keys.h).
struct VertexKey {
  std::int64_t a = 0, b = 0, c = 0;
  bool operator==(const VertexKey&) const = default;
};

class MidpointDisplacement {
 public:
  /// The vertices of skirts below tiles of 128 cells at the finest level have this one.
  static constexpr int kFinestGridLevel = FacePath::kMaxLevel + 8;

  /// Preconditions: amplitudeMeters >= 0, 0 <= regularity <= 64.
  MidpointDisplacement(double amplitudeMeters, double regularity, std::uint64_t seed) noexcept;

  /// Of a vertex that is new at the grid level, 0 .. kFinestGridLevel.
  double meters(int gridLevel, const VertexKey& key) const noexcept;

  /// D(l): no displacement of the level is larger.
  double largestMeters(int gridLevel) const noexcept { return largest_[static_cast<std::size_t>(gridLevel)]; }

  /// Proven: no height of the surface of grid level `finest` is farther from that of grid level `coarse` at the same
  /// place. The finer surface, linear within each triangle (bilinear in each square) of its grid, differs from the
  /// coarser one by what its new vertices were moved by, so level by level by D at most; and by rounding.
  double largestSumMeters(int coarse, int finest) const noexcept;

  /// Proven: no height is farther from 0.
  double largestHeightMeters() const noexcept;

  /// Proven: the ends of no edge of the grid differ by more. An edge of the next level is half of one, moved at one
  /// end, or runs between the middles of two, moved at both; the means of these differ by half the difference of two
  /// vertices that share an edge (of two pairs of such, for the middles of a square and its side). So the largest rise
  /// halves, and twice D is added.
  double largestRiseMeters(int gridLevel) const noexcept;

  /// Proven: no two vertices of a tile of the level, of whatever number of cells, differ by more: its corners by one
  /// rise, or by two across a square, and all others are means of these, moved by the levels that follow.
  double largestReliefMeters(Scheme scheme, int level) const noexcept;

 private:
  std::array<double, kFinestGridLevel + 1> largest_{};
  std::array<std::uint64_t, kFinestGridLevel + 1> seeds_{};
};

/// level^exponent by multiplications and square roots, each rounded as IEEE 754 says: the same bits everywhere.
/// Relative error below 1e-13 (midpoint_displacement_test). Preconditions: level >= 1, 0 <= exponent <= 64.
double powerOfLevel(int level, double exponent) noexcept;

/// The largest amplitude for a body, up to which
/// - no height is more than kMostHeight of the radius;
/// - every tile fits into the 16 bits of its lattice: two of its points are at most farthestPoints nominal widths apart
///   along the ground and largestReliefMeters in height, the root of the squares of both together;
/// - no edge of a tile's cells is steeper than kSteepestSlope (height_field.h).
double mostAmplitudeMeters(double radiusMeters, Scheme scheme, double regularity) noexcept;

inline constexpr double kMostHeight = 1.0 / 16;
/// A tile's longest diagonal or edge (midpoint_displacement_test), at the greatest height.
constexpr double farthestPoints(Scheme scheme) noexcept {
  return (scheme == Scheme::Cube ? 1.634 : 1.2) * (1.0 + kMostHeight);
}

}  // namespace terrane

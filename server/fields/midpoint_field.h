#pragma once
// Fractal ground by recursive midpoint displacement (midpoint_displacement.h), on the very grids that tiles are cut
// from: the surface of grid level l is linear within each triangle of the icosahedron's grid of that level, bilinear
// within each square of the cube's, in the coordinates of the face. No tile needs another: from the corners of its face
// the heights of its ancestors' corners follow, then those of its grid, one hash a vertex.
//
// Both schemes serve it. On the icosahedron a new vertex lies between the two ends of an edge; on the cube, too, or
// between the four corners of a square, which lie within one face. So what a vertex is made of never depends on the
// face it is seen from (midpoint_tilings.h says why, midpoint_field_test and seam_test hold all edges and corners to
// it). The two are different grounds: their vertices differ.
//
// A vertex has the same height at all levels that have it; only the gradient, the mean of the triangles or squares
// around it, is a level's own. Body frame, metres; immutable and thread-safe.

#include "server/fields/height_field.h"
#include "server/fields/midpoint_displacement.h"

namespace terrane {

class MidpointField final : public HeightField {
 public:
  /// Error (TooLarge, "midpoint.amplitude"): more than mostAmplitudeMeters.
  static Result<void> check(const Body& body);

  explicit MidpointField(const Body& body);

  /// Without batch.grid, a sample costs a walk down from the face, some microseconds, and gets the height of the
  /// surface at its direction (at the direction of a vertex, that vertex' height but for rounding) and the gradient of
  /// the triangle or square that it is in. Precondition: batch.grid is of the body's scheme.
  void evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const override;
  double omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept override;
  /// Samples of a grid that is at least as fine as the surface lose nothing.
  double interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept override;
  double roundingMeters(double /*minWavelengthMeters*/) const noexcept override { return 0; }
  HeightRange heightRange() const noexcept override;
  std::string identity() const override;

 private:
  /// The finest grid level whose displacements are shown: their wavelength is two of its cells.
  int gridLevelOf(double minWavelengthMeters) const noexcept;

  double radius_, amplitude_, regularity_;
  std::uint64_t seed_;
  Scheme scheme_;
  MidpointDisplacement displacement_;
};

}  // namespace terrane

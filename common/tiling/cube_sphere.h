#pragma once
// The equi-angular ("tangent-warped") cube sphere: face coordinates (s, t) in [-1, 1]^2 to unit directions in the body
// frame. A direction is normalise(n + tan(s pi/4) u + tan(t pi/4) v) with the face axes of face_path.h. Lines of
// constant s or t are great circles. (Ronchi, Iacono, Paolucci 1996, "The cubed sphere", section 2.)
//
// Deterministic: only + - x / sqrt in double, no libm. Two faces compute the very same bits for a point of their shared
// edge or corner, because tan is odd and exactly +-1 at +-1, and because the norm is summed in world axis order, never
// in face order. Thread-safe.

#include <cstdint>
#include <glm/vec3.hpp>

namespace terrane {

/// tan(x pi/4) for x in [-1, 1]. Odd to the bit; exactly 1 at 1. Relative error <= kTanQuarterPiError
/// (quarter_pi_test).
double tanQuarterPi(double x) noexcept;
inline constexpr double kTanQuarterPiError = 4.5e-16;

/// The inverse: (4/pi) atan(t) for t in [-1, 1]; odd to the bit; exactly 1 at 1; absolute error <= kAtanQuarterPiError.
double atanQuarterPi(double t) noexcept;
inline constexpr double kAtanQuarterPiError = 5e-16;
inline constexpr double kAtanQuarterPiRelativeError = 9e-16;

struct FaceAxes {
  glm::dvec3 normal, u, v;
};
const FaceAxes& cubeFaceAxes(int face) noexcept;

/// The unit direction of face coordinates (s, t); each component within kCubeDirectionError.
glm::dvec3 cubeDirection(int face, double s, double t) noexcept;
inline constexpr double kCubeDirectionError = 5e-16;

/// The unit direction of an exact integer position on a face: (column, row) in units of 2^-gridLevel of the face,
/// 0 <= column, row <= 2^gridLevel, gridLevel <= 52. Vertex (i, j) of a tile with 2^k cells is at gridLevel = level +
/// k.
glm::dvec3 cubeGridDirection(int face, int gridLevel, std::uint64_t column, std::uint64_t row) noexcept;

struct FaceCoordinates {
  int face;
  double s, t;
};
/// Any finite non-zero vector, of any length. Ties between faces go to the lowest face index.
FaceCoordinates cubeFaceCoordinates(const glm::dvec3& direction) noexcept;

}  // namespace terrane

#pragma once
// A position on lattices of power-of-two wavelengths: which cell of each it lies in, and where in that cell. This is
// what a texture without end is drawn with: the camera's place in every octave is taken apart here, in double, where it
// is exact, and a shader only adds what lies near the camera. Body frame, metres. Pure, thread-safe.
//
// For a point p = camera + r, with r in float, a shader computes cell + floor(rest + r / wavelength) and the fraction
// that remains. u = 2^-24. Division by a power of two is exact, so that the coordinate, in wavelengths, is off by at
// most
//   u (rest, rounded to float) + u (|r| / wavelength + 1) (the sum),
// in metres 2 u wavelength + u |r|: relative to the distance from the camera, never to that from the body's centre.

#include <glm/ext/vector_int3_sized.hpp>
#include <glm/vec3.hpp>

#include "common/numerics/strict_math.h"

namespace terrane {

struct OctaveCoordinates {
  glm::ivec3 cell{0};    ///< whole wavelengths modulo 2^32, rounded down
  glm::vec3 rest{0.0f};  ///< the fraction in wavelengths, 0..1 (1 where float rounds up to it)
};

/// Wavelength 2^exponent metres, exponent -100..100. A component that is not finite gives 0.
OctaveCoordinates octaveCoordinates(const glm::dvec3& positionBody, int exponent) noexcept;

}  // namespace terrane

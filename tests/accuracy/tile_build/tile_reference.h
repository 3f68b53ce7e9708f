#pragma once
// What the loops of a tile build should give: tangents by MPFR, the rest in long double, whose 2^-64 of the radius is
// some 10^-13 m on the Moon. Body frame, metres.

#include <span>
#include <vector>

#include "common/tiling/face_path.h"
#include "server/fields/lunar_program.h"

namespace terrane::accuracy {

struct ReferenceVector {
  long double x, y, z;
};

/// The grid's unit directions; vertex (i, j) is at j * (cells + 1) + i, as in GridDirections.
std::vector<ReferenceVector> referenceDirections(const FacePath& path, int cellsPerEdge);

/// The sum of the octaves, by the server's noise in long double.
long double referenceHeightMeters(std::span<const lunar::NoiseOctave> octaves, const ReferenceVector& positionMeters);

}  // namespace terrane::accuracy

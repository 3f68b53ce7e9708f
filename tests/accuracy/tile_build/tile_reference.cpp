#include "tests/accuracy/tile_build/tile_reference.h"

#include <cfloat>
#include <cmath>

#include "common/tiling/cube_sphere.h"
#include "tests/support/double_float_operands.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
namespace terrane::lunar {
#include "server/fields/lunar_noise.inl"
}  // namespace terrane::lunar
#pragma GCC diagnostic pop

static_assert(LDBL_MANT_DIG >= 64, "the reference needs more digits than double's");

namespace terrane::accuracy {
namespace {

using test::HighPrecision;

std::vector<long double> lineTangents(std::uint64_t first, int cellsPerEdge, int gridLevel) {
  static const HighPrecision kQuarterPi = atan(HighPrecision(1));
  std::vector<long double> tangents;
  const std::int64_t half = std::int64_t{1} << gridLevel;
  for (int i = 0; i <= cellsPerEdge; ++i) {
    const auto line = 2 * static_cast<std::int64_t>(first + static_cast<std::uint64_t>(i)) - half;
    const HighPrecision angle = kQuarterPi * std::ldexp(static_cast<double>(line), -gridLevel);
    tangents.push_back(HighPrecision(tan(angle)).convert_to<long double>());
  }
  return tangents;
}

struct Split {
  std::uint32_t cell;
  long double within;
};
/// To the nearest cell, which the server's noise calls by its middle.
Split split(long double position, double inverseWavelength, double offset) {
  const long double t = position * static_cast<long double>(inverseWavelength) + static_cast<long double>(offset);
  const long double cell = std::floor(t + 0.5L);
  return {static_cast<std::uint32_t>(static_cast<std::int64_t>(cell)), (t - cell) + 0.5L};
}

}  // namespace

std::vector<ReferenceVector> referenceDirections(const FacePath& path, int cellsPerEdge) {
  const int gridLevel = path.level() + std::ilogb(cellsPerEdge);
  const auto cells = static_cast<std::uint64_t>(cellsPerEdge);
  const auto u = lineTangents(path.column() * cells, cellsPerEdge, gridLevel);
  const auto v = lineTangents(path.row() * cells, cellsPerEdge, gridLevel);
  const FaceAxes& axes = cubeFaceAxes(path.face());
  std::vector<ReferenceVector> out;
  for (const long double b : v) {
    for (const long double a : u) {
      const auto along = [&](int axis) {
        return static_cast<long double>(axes.normal[axis]) + static_cast<long double>(axes.u[axis]) * a +
               static_cast<long double>(axes.v[axis]) * b;
      };
      const long double norm = std::sqrt(1.0L + a * a + b * b);
      out.push_back({along(0) / norm, along(1) / norm, along(2) / norm});
    }
  }
  return out;
}

long double referenceHeightMeters(std::span<const lunar::NoiseOctave> octaves, const ReferenceVector& p) {
  long double sum = 0;
  for (const lunar::NoiseOctave& octave : octaves) {
    const Split x = split(p.x, octave.inverseWavelength, octave.offset[0]);
    const Split y = split(p.y, octave.inverseWavelength, octave.offset[1]);
    const Split z = split(p.z, octave.inverseWavelength, octave.offset[2]);
    const lunar::Cell cell = lunar::cellDirections(x.cell, y.cell, z.cell, octave.seed);
    sum += static_cast<long double>(octave.amplitude) *
           lunar::noiseInCell<long double>(cell, x.within, y.within, z.within).value;
  }
  return sum;
}

}  // namespace terrane::accuracy

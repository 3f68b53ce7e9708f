#pragma once
// The loops of a tile build, each as one template over the type of its numbers, so that float and double differ in
// nothing else. One build for each SIMD level (tile_loops_*.cpp), as the server's kernels have, and for the same reason
// with plain data only: no build may emit a function that the linker could pick for an older CPU. Body frame, metres.

#include <cstddef>
#include <cstdint>

#include "tests/accuracy/tile_build/sample_block.h"

namespace terrane::accuracy {

/// Structure of arrays.
template <class T>
struct Triples {
  T *x, *y, *z;
};

template <class Real>
struct FaceAxesOf {
  Real normal[3], u[3], v[3];
};

template <class Real>
struct TileLoopsOf {
  /// What gridDirections does once it has the tangents of its lines; side^2 unit vectors.
  void (*directions)(const FaceAxesOf<Real>& axes, const Real* tangentsU, const Real* tangentsV, std::size_t side,
                     Triples<Real> out);
  void (*positions)(Triples<const Real> directions, const Real* heights, Real radius, std::size_t count,
                    Triples<Real> out);
  /// Positions in steps, to the nearest, halves up: what placeVertices does; x, y, z in turn.
  void (*lattice)(Triples<const Real> directions, const Real* heights, Real radius, Real stepsPerMeter,
                  std::size_t count, std::int64_t* out);
  /// As the tile builder does: (1 + h / R) d - gradient, of length 1; x, y, z in turn.
  void (*gradientNormals)(Triples<const Real> directions, const Real* heights, Triples<const float> gradient,
                          Real radius, std::size_t count, float* out);
  /// The cross product of what lies between the neighbours along both lines; the tile's border is left as it is.
  void (*neighbourNormals)(Triples<const Real> positions, std::size_t side, float* out);
};

struct OctaveSum {
  const lunar::NoiseOctave* octaves;
  std::size_t count;
  std::size_t broad;  ///< so many of the first are computed in double where the loop has doubles at all
};

/// Heights, and gradients without their sphere, at blocks of kBlockSamples positions each.
template <class Position>
using OctaveLoop = void (*)(const OctaveSum& sum, Triples<const Position> positions, std::size_t blocks,
                            double* heights, Triples<float> gradient);

struct TileLoops {
  TileLoopsOf<float> inFloat;
  TileLoopsOf<double> inDouble;
  OctaveLoop<float> octavesInFloat;
  OctaveLoop<double> octavesInCells;  ///< cells split in double, float within but for broad ones: the server's way
  OctaveLoop<double> octavesInDouble;
};

const TileLoops& tileLoopsDefault() noexcept;
const TileLoops& tileLoopsV3() noexcept;
const TileLoops& tileLoopsV4() noexcept;

}  // namespace terrane::accuracy

#pragma once
// One tile through the loops of a tile build in every way: all in float, float within noise cells only (the server's
// way), all in double; with the errors of each loop and its time.

#include <array>
#include <vector>

#include "server/fields/height_field.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/tile_build/tile_chain.h"

namespace terrane::accuracy {

enum Loop : std::size_t { kDirections, kNoise, kNoiseInCells, kLattice, kGradientNormals, kNeighbourNormals, kLoops };
/// All that the loops give in one type for one tile.
template <class Real>
struct Results {
  Columns<Real> directions{kVertices};
  Columns<Real> blocks{kSlots};  ///< what the octaves are given
  Ground ground;
  std::vector<std::int64_t> lattice, fineLattice;  ///< of the ground above; in steps of 2^kFinestExponent m
};

/// One tile through all loops in every way.
struct Tile {
  Place place;
  OctaveSum sum, sumInFloat;
  Results<float> inFloat;
  Results<double> inCells, inDouble;

  Tile(Place where, const TileLoops& loops);
  Tile(const Tile&) = delete;
  Tile& operator=(const Tile&) = delete;
};

/// Of whole tiles too: a vertex, all loops in a row.
struct ErrorsMeters {
  std::array<double, kLoops> inFloat{}, inDouble{};
  double wholeFloat = 0, wholeInCells = 0, wholeDouble = 0;
};

/// Compared at every `stride`th vertex of a line.
ErrorsMeters errorsOf(const Tile& tile, const TileLoops& loops, std::size_t stride);

/// A vertex.
struct TimesNs {
  std::array<double, kLoops> inFloat{}, inDouble{};

  double whole(const std::array<double, kLoops>& of, Loop noise) const {
    return of[kDirections] + of[noise] + of[kLattice] + of[kGradientNormals];
  }
  double wholeFloat() const { return whole(inFloat, kNoise); }
  double wholeDouble() const { return whole(inDouble, kNoise); }
  double wholeInCells() const { return wholeDouble() - inDouble[kNoise] + inFloat[kNoiseInCells]; }
};

/// Each loop but noise, in float and then in double; items are vertices, whole tiles are worked through.
std::vector<Work> loopWorks(const Tile& tile, const TileLoops& loops);
inline constexpr std::size_t kLoopWorks = 8;
/// Noise in float, in cells and in double, on one line of blocks: a whole tile takes so long that something else often
/// runs in between. Items are vertices.
std::vector<Work> noiseWorks(const Tile& tile, const TileLoops& loops, std::size_t blockLine);
inline constexpr std::size_t kNoiseWorks = 3;
TimesNs timesFrom(const double* loopNs, const double* noiseNs);

template <class Once>
Work repeated(std::size_t itemsOnce, Once once) {
  return [itemsOnce, once](std::size_t count) {
    double sum = 0;
    for (std::size_t done = 0; done < count; done += itemsOnce) sum += once();
    return sum;
  };
}

const TileLoops& loopsOf(SimdPath path);

}  // namespace terrane::accuracy

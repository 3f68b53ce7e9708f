#pragma once
// One tile's vertices through the loops of tile_loops.h, in one type of number: tangents, directions, heights, lattice.
// Body frame, metres.

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/face_path.h"
#include "common/tiling/lattice.h"
#include "common/tiling/quarter_pi_polynomials.h"
#include "tests/accuracy/tile_build/lunar_octaves.h"
#include "tests/accuracy/tile_build/sample_block.h"
#include "tests/accuracy/tile_build/tile_loops.h"

namespace terrane::accuracy {

inline constexpr int kCells = 64;
inline constexpr std::size_t kSide = kCells + 1, kVertices = kSide * kSide;
/// A tile is cut into 5 x 5 blocks of 13 x 13 vertices.
inline constexpr std::size_t kBlocksPerLine = kSide / kBlockSide, kBlocks = kBlocksPerLine * kBlocksPerLine;
inline constexpr std::size_t kLineSlots = kBlocksPerLine * kBlockSamples, kLineVertices = kVertices / kBlocksPerLine;
inline constexpr std::size_t kSlots = kBlocks * kBlockSamples;
static_assert(kBlocksPerLine * kBlockSide == kSide);

template <class T>
struct Columns {
  std::vector<T> x, y, z;
  explicit Columns(std::size_t count) : x(count), y(count), z(count) {}
  Triples<T> out() { return {x.data(), y.data(), z.data()}; }
  Triples<const T> in() const { return {x.data(), y.data(), z.data()}; }
};

/// A tile of a body, and the octaves that its cells can show.
struct Place {
  double radiusMeters;
  FacePath path;
  int stepExponent;
  double cellMeters;
  std::vector<lunar::NoiseOctave> octaves;
  double doubleWavelength;  ///< metres: the server computes octaves from here on in double
  std::size_t broad;        ///< how many there are of them
};

inline Place placeAt(double radiusMeters, int level, std::uint64_t seed) {
  const std::uint32_t third = (1u << level) / 3;
  Place place{radiusMeters, FacePath::cubeTile(0, level, third, third), stepExponent(radiusMeters, level), 0, {}, 0, 0};
  place.cellMeters = nominalTileWidthMeters(radiusMeters, level) / kCells;
  const int finest = std::ilogb(2 * place.cellMeters) + 1, coarsest = std::ilogb(radiusMeters);
  place.octaves = lunarOctaves(coarsest, finest, seed);
  place.doubleWavelength = lunar::kDoubleWavelengths * 2 * place.cellMeters;
  for (const lunar::NoiseOctave& octave : place.octaves)
    place.broad += place.doubleWavelength * octave.inverseWavelength <= 1 ? 1 : 0;
  return place;
}

/// The operations of tanQuarterPi.
template <class Real>
Real tanQuarterPiIn(Real x) {
  const Real magnitude = std::fabs(x);
  const bool folded = magnitude > Real(quarter_pi::kTangentRange);
  const Real reduced = folded ? Real(1) - magnitude : magnitude, y = reduced * reduced;
  auto sum = static_cast<Real>(quarter_pi::kTangent.back());
  for (std::size_t i = quarter_pi::kTangent.size() - 1; i-- > 0;)
    sum = sum * y + static_cast<Real>(quarter_pi::kTangent[i]);
  const Real tangent = reduced * static_cast<Real>(quarter_pi::kTangentHigh) +
                       reduced * (y * sum + static_cast<Real>(quarter_pi::kTangentLow));
  return std::copysign(folded ? (Real(1) - tangent) / (Real(1) + tangent) : tangent, x);
}

template <class Real>
std::array<Real, kSide> lineTangentsIn(std::uint64_t tile, int level) {
  const int gridLevel = level + std::ilogb(kCells);
  const auto scale = static_cast<Real>(std::ldexp(1.0, -gridLevel));
  const std::int64_t half = std::int64_t{1} << gridLevel;
  std::array<Real, kSide> tangents{};
  for (std::size_t i = 0; i < kSide; ++i) {
    const auto line = static_cast<std::int64_t>(tile * kCells + i);
    tangents[i] = tanQuarterPiIn(static_cast<Real>(2 * line - half) * scale);
  }
  return tangents;
}

template <class Real>
void directionsOf(const Place& place, const TileLoopsOf<Real>& loops, Columns<Real>& out) {
  const FaceAxes& from = cubeFaceAxes(place.path.face());
  FaceAxesOf<Real> axes{};
  for (int k = 0; k < 3; ++k) {
    axes.normal[k] = static_cast<Real>(from.normal[k]);
    axes.u[k] = static_cast<Real>(from.u[k]);
    axes.v[k] = static_cast<Real>(from.v[k]);
  }
  const auto u = lineTangentsIn<Real>(place.path.column(), place.path.level());
  const auto v = lineTangentsIn<Real>(place.path.row(), place.path.level());
  loops.directions(axes, u.data(), v.data(), kSide, out.out());
}

/// The vertex of each slot of the blocks; the last of a block fills up its chunk.
inline std::vector<std::size_t> vertexOfSlot() {
  std::vector<std::size_t> vertices;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t row = block / kBlocksPerLine * kBlockSide, column = block % kBlocksPerLine * kBlockSide;
    for (std::size_t slot = 0; slot < kBlockSamples; ++slot) {
      const std::size_t k = std::min(slot, kBlockSide * kBlockSide - 1);
      vertices.push_back((row + k / kBlockSide) * kSide + column + k % kBlockSide);
    }
  }
  return vertices;
}

/// Where the octaves are sampled, block by block: on the sphere.
template <class Real>
Columns<Real> blockPositions(const Columns<Real>& directions, double radiusMeters) {
  Columns<Real> out(kSlots);
  const auto radius = static_cast<Real>(radiusMeters);
  const std::vector<std::size_t> vertices = vertexOfSlot();
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    out.x[slot] = directions.x[vertices[slot]] * radius;
    out.y[slot] = directions.y[vertices[slot]] * radius;
    out.z[slot] = directions.z[vertices[slot]] * radius;
  }
  return out;
}

struct Ground {
  std::vector<double> heightMeters;
  Columns<float> gradient;
};

inline OctaveSum octaveSum(const Place& place) { return {place.octaves.data(), place.octaves.size(), place.broad}; }

template <class Real>
Ground groundOf(const OctaveSum& sum, OctaveLoop<Real> loop, const Columns<Real>& positions) {
  std::vector<double> heights(kSlots);
  Columns<float> gradient(kSlots);
  loop(sum, positions.in(), kBlocks, heights.data(), gradient.out());
  Ground ground{std::vector<double>(kVertices), Columns<float>(kVertices)};
  const std::vector<std::size_t> vertices = vertexOfSlot();
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    const std::size_t vertex = vertices[slot];
    ground.heightMeters[vertex] = heights[slot];
    ground.gradient.x[vertex] = gradient.x[slot];
    ground.gradient.y[vertex] = gradient.y[slot];
    ground.gradient.z[vertex] = gradient.z[slot];
  }
  return ground;
}

template <class Real>
std::vector<Real> inType(const std::vector<double>& values) {
  std::vector<Real> out;
  for (const double value : values) out.push_back(static_cast<Real>(value));
  return out;
}

/// In steps of 2^exponent metres: the level's own, or so fine that rounding hides nothing.
template <class Real>
std::vector<std::int64_t> latticeOf(const Place& place, int exponent, const TileLoopsOf<Real>& loops,
                                    const Columns<Real>& directions, const std::vector<double>& heightMeters) {
  std::vector<std::int64_t> out(3 * kVertices);
  loops.lattice(directions.in(), inType<Real>(heightMeters).data(), static_cast<Real>(place.radiusMeters),
                static_cast<Real>(stepMeters(-exponent)), kVertices, out.data());
  return out;
}
inline constexpr int kFinestExponent = -40;  ///< some 10^-12 m; an Earth's radius is below 2^63 of them

}  // namespace terrane::accuracy

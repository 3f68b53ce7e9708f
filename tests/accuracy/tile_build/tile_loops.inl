// The loops of tile_loops.h: part of every build of them. Included with kTileLoops naming the entry. The operations are
// the product's, in its order.

#include "common/numerics/strict_math.h"
#include "tests/accuracy/tile_build/tile_loops.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
namespace terrane::lunar {
#include "server/fields/lunar_noise.inl"
}  // namespace terrane::lunar
#pragma GCC diagnostic pop

namespace terrane::accuracy {
namespace {

using lunar::NoiseOctave;

TERRANE_INLINE float squareRoot(float v) { return __builtin_sqrtf(v); }
TERRANE_INLINE double squareRoot(double v) { return __builtin_sqrt(v); }

template <class Real>
void directions(const FaceAxesOf<Real>& axes, const Real* tangentsU, const Real* tangentsV, std::size_t side,
                Triples<Real> out) {
  const Real nx = axes.normal[0], ny = axes.normal[1], nz = axes.normal[2];
  const Real ux = axes.u[0], uy = axes.u[1], uz = axes.u[2];
  for (std::size_t j = 0; j < side; ++j) {
    const Real b = tangentsV[j], vx = axes.v[0] * b, vy = axes.v[1] * b, vz = axes.v[2] * b;
    Real *x = out.x + j * side, *y = out.y + j * side, *z = out.z + j * side;
    for (std::size_t i = 0; i < side; ++i) {
      const Real a = tangentsU[i];
      const Real px = (nx + ux * a) + vx, py = (ny + uy * a) + vy, pz = (nz + uz * a) + vz;
      const Real norm = squareRoot((px * px + py * py) + pz * pz);
      x[i] = px / norm;
      y[i] = py / norm;
      z[i] = pz / norm;
    }
  }
}

template <class Real>
void scale(const Real* directions, const Real* heights, Real radius, std::size_t count, Real* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = directions[i] * (radius + heights[i]);
}
template <class Real>
void positions(Triples<const Real> d, const Real* heights, Real radius, std::size_t count, Triples<Real> out) {
  scale(d.x, heights, radius, count, out.x);
  scale(d.y, heights, radius, count, out.y);
  scale(d.z, heights, radius, count, out.z);
}

template <class Real>
TERRANE_INLINE std::int64_t roundHalfUp(Real x) {
  const auto towardsZero = static_cast<std::int64_t>(x);
  const std::int64_t lower = towardsZero - (static_cast<Real>(towardsZero) > x ? 1 : 0);
  return lower + (x - static_cast<Real>(lower) >= Real(0.5) ? 1 : 0);
}

template <class Real>
void lattice(Triples<const Real> d, const Real* heights, Real radius, Real stepsPerMeter, std::size_t count,
             std::int64_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const Real length = radius + heights[i];
    out[3 * i] = roundHalfUp<Real>((d.x[i] * length) * stepsPerMeter);
    out[3 * i + 1] = roundHalfUp<Real>((d.y[i] * length) * stepsPerMeter);
    out[3 * i + 2] = roundHalfUp<Real>((d.z[i] * length) * stepsPerMeter);
  }
}

template <class Real>
TERRANE_INLINE void storeUnit(Real x, Real y, Real z, float* out) {
  const Real norm = squareRoot((x * x + y * y) + z * z);
  out[0] = static_cast<float>(x / norm);
  out[1] = static_cast<float>(y / norm);
  out[2] = static_cast<float>(z / norm);
}

template <class Real>
void gradientNormals(Triples<const Real> d, const Real* heights, Triples<const float> gradient, Real radius,
                     std::size_t count, float* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const Real radial = Real(1) + heights[i] / radius;
    const Real x = d.x[i] * radial - static_cast<Real>(gradient.x[i]);
    const Real y = d.y[i] * radial - static_cast<Real>(gradient.y[i]);
    const Real z = d.z[i] * radial - static_cast<Real>(gradient.z[i]);
    storeUnit(x, y, z, out + 3 * i);
  }
}

template <class Real>
void neighbourNormals(Triples<const Real> p, std::size_t side, float* out) {
  for (std::size_t j = 1; j + 1 < side; ++j) {
    for (std::size_t i = 1; i + 1 < side; ++i) {
      const std::size_t at = j * side + i, before = at - side, after = at + side;
      const Real ux = p.x[at + 1] - p.x[at - 1], uy = p.y[at + 1] - p.y[at - 1], uz = p.z[at + 1] - p.z[at - 1];
      const Real vx = p.x[after] - p.x[before], vy = p.y[after] - p.y[before], vz = p.z[after] - p.z[before];
      storeUnit(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx, out + 3 * at);
    }
  }
}

/// Double takes the server's way to the nearest cell; its magic number would leave float only 22 bits for the cell.
TERRANE_INLINE double nearestCell(double t) { return lunar::roundToCell(t); }
TERRANE_INLINE std::uint32_t indexOfCell(double t) { return lunar::cellIndex(t); }
TERRANE_INLINE std::int32_t floorOf(float t) {
  const auto towardsZero = static_cast<std::int32_t>(t);
  return towardsZero - (static_cast<float>(towardsZero) > t ? 1 : 0);
}
TERRANE_INLINE float nearestCell(float t) { return static_cast<float>(floorOf(t + 0.5f)); }
TERRANE_INLINE std::uint32_t indexOfCell(float t) { return static_cast<std::uint32_t>(floorOf(t + 0.5f)); }

template <class Position, class Real>
TERRANE_INLINE Real withinCell(Position t) {
  return static_cast<Real>((t - nearestCell(t)) + Position(0.5));
}

/// A block's positions along one axis, as the cells of an octave have them.
template <class Position>
struct AxisInCells {
  const Position* p;
  Position inverse, offset, low, high;
  TERRANE_INLINE Position at(std::size_t i) const { return p[i] * inverse + offset; }
  TERRANE_INLINE bool oneCell() const { return nearestCell(low) == nearestCell(high); }
};

template <class Position>
AxisInCells<Position> axisInCells(const Position* p, const Position* bounds, const NoiseOctave& octave, int axis) {
  const auto inverse = static_cast<Position>(octave.inverseWavelength);
  const auto offset = static_cast<Position>(octave.offset[axis]);
  return {p, inverse, offset, bounds[0] * inverse + offset, bounds[1] * inverse + offset};
}

template <class Sum>
struct Sums {
  alignas(64) Sum height[kBlockSamples];
  alignas(64) float x[kBlockSamples], y[kBlockSamples], z[kBlockSamples];
};

template <class Real, class Sum>
TERRANE_INLINE void add(const lunar::Noise<Real>& n, Sum amplitude, float slope, std::size_t i, Sums<Sum>& sums) {
  sums.height[i] += amplitude * static_cast<Sum>(n.value);
  sums.x[i] += slope * static_cast<float>(n.x);
  sums.y[i] += slope * static_cast<float>(n.y);
  sums.z[i] += slope * static_cast<float>(n.z);
}

template <class Real, class Position, class Sum>
void addOctave(Triples<const Position> p, const Position (*bounds)[2], const NoiseOctave& octave, Sums<Sum>& sums) {
  const auto ax = axisInCells(p.x, bounds[0], octave, 0), ay = axisInCells(p.y, bounds[1], octave, 1),
             az = axisInCells(p.z, bounds[2], octave, 2);
  const auto amplitude = static_cast<Sum>(octave.amplitude);
  const auto slope = static_cast<float>(octave.amplitude * octave.inverseWavelength);
  if (ax.oneCell() && ay.oneCell() && az.oneCell()) {
    const lunar::Cell cell =
        lunar::cellDirections(indexOfCell(ax.low), indexOfCell(ay.low), indexOfCell(az.low), octave.seed);
    const Position rx = nearestCell(ax.low), ry = nearestCell(ay.low), rz = nearestCell(az.low);
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
      const Real fx = static_cast<Real>((ax.at(i) - rx) + Position(0.5));
      const Real fy = static_cast<Real>((ay.at(i) - ry) + Position(0.5));
      const Real fz = static_cast<Real>((az.at(i) - rz) + Position(0.5));
      add(lunar::noiseInCell<Real>(cell, fx, fy, fz), amplitude, slope, i, sums);
    }
    return;
  }
  alignas(64) Real f[3][kBlockSamples];
  alignas(64) std::uint32_t index[3][kBlockSamples];
  const AxisInCells<Position> axes[3] = {ax, ay, az};
  for (int axis = 0; axis < 3; ++axis) {
    const AxisInCells<Position> along = axes[axis];
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
      f[axis][i] = withinCell<Position, Real>(along.at(i));
      index[axis][i] = indexOfCell(along.at(i));
    }
  }
  for (std::size_t i = 0; i < kBlockSamples; ++i) {
    const lunar::Cell cell = lunar::cellDirections(index[0][i], index[1][i], index[2][i], octave.seed);
    add(lunar::noiseInCell<Real>(cell, f[0][i], f[1][i], f[2][i]), amplitude, slope, i, sums);
  }
}

template <class Position>
void findBounds(const Position* p, Position* bounds) {
  Position low[8], high[8];
  for (int j = 0; j < 8; ++j) low[j] = high[j] = p[j];
  for (std::size_t i = 8; i < kBlockSamples; i += 8) {
    for (int j = 0; j < 8; ++j) {
      const Position value = p[i + static_cast<std::size_t>(j)];
      low[j] = value < low[j] ? value : low[j];
      high[j] = value > high[j] ? value : high[j];
    }
  }
  bounds[0] = low[0];
  bounds[1] = high[0];
  for (int j = 1; j < 8; ++j) {
    bounds[0] = low[j] < bounds[0] ? low[j] : bounds[0];
    bounds[1] = high[j] > bounds[1] ? high[j] : bounds[1];
  }
}

template <class Sum>
void clear(Sums<Sum>& sums) {
  for (std::size_t i = 0; i < kBlockSamples; ++i) {
    sums.height[i] = Sum(0);
    sums.x[i] = sums.y[i] = sums.z[i] = 0.0f;
  }
}

template <class Position, class Fine>
void sumOctaves(const OctaveSum& sum, Triples<const Position> all, std::size_t blocks, double* heights,
                Triples<float> gradient) {
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t first = block * kBlockSamples;
    const Triples<const Position> p{all.x + first, all.y + first, all.z + first};
    Position bounds[3][2];
    findBounds(p.x, bounds[0]);
    findBounds(p.y, bounds[1]);
    findBounds(p.z, bounds[2]);
    Sums<Position> sums;
    clear(sums);
    for (std::size_t k = 0; k < sum.count; ++k) {
      if (k < sum.broad) {
        addOctave<Position>(p, bounds, sum.octaves[k], sums);
      } else {
        addOctave<Fine>(p, bounds, sum.octaves[k], sums);
      }
    }
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
      heights[first + i] = static_cast<double>(sums.height[i]);
      gradient.x[first + i] = sums.x[i];
      gradient.y[first + i] = sums.y[i];
      gradient.z[first + i] = sums.z[i];
    }
  }
}

template <class Real>
constexpr TileLoopsOf<Real> kLoopsOf{directions<Real>, positions<Real>, lattice<Real>, gradientNormals<Real>,
                                     neighbourNormals<Real>};

}  // namespace

const TileLoops& kTileLoops() noexcept {
  static constexpr TileLoops kLoops{kLoopsOf<float>, kLoopsOf<double>, sumOctaves<float, float>,
                                    sumOctaves<double, float>, sumOctaves<double, double>};
  return kLoops;
}

}  // namespace terrane::accuracy

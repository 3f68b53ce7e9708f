// Gradient noise: part of every build of the lunar kernels (lunar_kernels_*.cpp). Classic Perlin noise (Perlin 2002,
// "Improving noise") with the twelve edge directions chosen by an integer hash and the quintic fade, so twice
// continuously differentiable. Only + - * on floats and integer operations: every vector build gives the same bits.

namespace {

// Adding this to |t| < 2^51 rounds t to the nearest integer, which then stands in the low bits of the double.
constexpr double kRoundingMagic = 6755399441055744.0;  // 1.5 * 2^52

constexpr std::uint32_t kHashX = 0x9E3779B1u, kHashY = 0x85EBCA77u, kHashZ = 0xC2B2AE3Du;

TERRANE_INLINE std::uint32_t cornerHash(std::uint32_t sum) {
  sum ^= sum >> 15;
  sum *= 0x2C1B3C6Du;
  sum ^= sum >> 13;
  sum *= 0x297A2D39u;
  return sum ^ (sum >> 15);
}

/// One of (0, +-1, +-1), (+-1, 0, +-1), (+-1, +-1, 0).
struct Direction {
  float x, y, z;
};
TERRANE_INLINE Direction cornerDirection(std::uint32_t sum) {
  const std::uint32_t h = cornerHash(sum);
  // Of hashes, taken as signed, the lowest third has no x and the highest no z. In shifts, not in comparisons, of which
  // compilers make slower selections.
  constexpr std::int32_t kSixth = 357913941;
  const std::int32_t half = static_cast<std::int32_t>(h) >> 1;
  const auto hasNoX = static_cast<std::uint32_t>((half + kSixth) >> 31),
             hasNoZ = static_cast<std::uint32_t>((kSixth - 1 - half) >> 31);
  constexpr std::uint32_t kOne = 0x3F800000u, kSign = 0x80000000u;
  return {__builtin_bit_cast(float, (kOne | ((h << 31) & kSign)) & ~hasNoX),
          __builtin_bit_cast(float, (kOne | ((h << 30) & kSign)) & (hasNoX | hasNoZ)),
          __builtin_bit_cast(float, (kOne | ((h << 29) & kSign)) & ~hasNoZ)};
}

struct Cell {
  Direction corner[8];  ///< bit 0 x, bit 1 y, bit 2 z
};
TERRANE_INLINE Cell cellDirections(std::uint32_t ix, std::uint32_t iy, std::uint32_t iz, std::uint32_t seed) {
  const std::uint32_t x0 = ix * kHashX + seed, x1 = x0 + kHashX;
  const std::uint32_t y0 = iy * kHashY, y1 = y0 + kHashY;
  const std::uint32_t z0 = iz * kHashZ, z1 = z0 + kHashZ;
  return {{cornerDirection(x0 + y0 + z0), cornerDirection(x1 + y0 + z0), cornerDirection(x0 + y1 + z0),
           cornerDirection(x1 + y1 + z0), cornerDirection(x0 + y0 + z1), cornerDirection(x1 + y0 + z1),
           cornerDirection(x0 + y1 + z1), cornerDirection(x1 + y1 + z1)}};
}

template <class Real>
TERRANE_INLINE Real lerp(Real a, Real b, Real t) {
  return a + t * (b - a);
}

template <class Real>
struct Noise {
  Real value, x, y, z;  ///< and its gradient, per cell
};

template <class Real>
TERRANE_INLINE Real trilinear(Real a, Real b, Real c, Real d, Real e, Real f, Real g, Real h, Real u, Real v, Real w) {
  return lerp(lerp(lerp(a, b, u), lerp(c, d, u), v), lerp(lerp(e, f, u), lerp(g, h, u), v), w);
}

template <class Real>
TERRANE_INLINE Real cornerHeight(const Direction& g, Real x, Real y, Real z) {
  return (static_cast<Real>(g.x) * x + static_cast<Real>(g.y) * y) + static_cast<Real>(g.z) * z;
}

/// fx, fy, fz in [0, 1]: the position within the cell.
template <class Real>
TERRANE_INLINE Noise<Real> noiseInCell(const Cell& cell, Real fx, Real fy, Real fz) {
  const Real one(1), gx = fx - one, gy = fy - one, gz = fz - one;
  const Direction* c = cell.corner;
  const Real d0 = cornerHeight(c[0], fx, fy, fz), d1 = cornerHeight(c[1], gx, fy, fz);
  const Real d2 = cornerHeight(c[2], fx, gy, fz), d3 = cornerHeight(c[3], gx, gy, fz);
  const Real d4 = cornerHeight(c[4], fx, fy, gz), d5 = cornerHeight(c[5], gx, fy, gz);
  const Real d6 = cornerHeight(c[6], fx, gy, gz), d7 = cornerHeight(c[7], gx, gy, gz);

  const Real six(6), fifteen(15), ten(10), thirty(30);
  const Real u = fx * fx * fx * (fx * (fx * six - fifteen) + ten), du = thirty * (fx * gx) * (fx * gx);
  const Real v = fy * fy * fy * (fy * (fy * six - fifteen) + ten), dv = thirty * (fy * gy) * (fy * gy);
  const Real w = fz * fz * fz * (fz * (fz * six - fifteen) + ten), dw = thirty * (fz * gz) * (fz * gz);

  const Real e0 = d1 - d0, e1 = d3 - d2, e2 = d5 - d4, e3 = d7 - d6;
  const Real x0 = d0 + u * e0, x1 = d2 + u * e1, x2 = d4 + u * e2, x3 = d6 + u * e3;
  const Real s0 = x1 - x0, s1 = x3 - x2;
  const Real y0 = x0 + v * s0, y1 = x2 + v * s1;
  const Real alongU = lerp(lerp(e0, e1, v), lerp(e2, e3, v), w), alongV = lerp(s0, s1, w), alongW = y1 - y0;

#define TERRANE_AT(axis)                                                                        \
  static_cast<Real>(c[0].axis), static_cast<Real>(c[1].axis), static_cast<Real>(c[2].axis),     \
      static_cast<Real>(c[3].axis), static_cast<Real>(c[4].axis), static_cast<Real>(c[5].axis), \
      static_cast<Real>(c[6].axis), static_cast<Real>(c[7].axis)
  Noise<Real> n;
  n.value = y0 + w * alongW;
  n.x = trilinear(TERRANE_AT(x), u, v, w) + du * alongU;
  n.y = trilinear(TERRANE_AT(y), u, v, w) + dv * alongV;
  n.z = trilinear(TERRANE_AT(z), u, v, w) + dw * alongW;
#undef TERRANE_AT
  return n;
}

/// What is asked of a kernel. Of a tile's borders only heights are, and slopes and colours take most of the time.
/// Heights have the same bits either way.
enum class Wanted { All, Heights };

/// One octave over a block.
template <class Real>
struct OctaveSamples {
  alignas(64) Real value[kBlockCapacity];
  alignas(64) float x[kBlockCapacity], y[kBlockCapacity], z[kBlockCapacity];
};

struct RotatedBlock {
  const double *x, *y, *z;
  std::size_t count;
  double low[3], high[3];
};

TERRANE_INLINE double roundToCell(double t) { return (t + kRoundingMagic) - kRoundingMagic; }
TERRANE_INLINE std::uint32_t cellIndex(double t) {
  return static_cast<std::uint32_t>(__builtin_bit_cast(std::uint64_t, t + kRoundingMagic));
}

template <class Real>
TERRANE_INLINE void storeGradient(const Noise<Real>& n, std::size_t i, OctaveSamples<Real>& out) {
  out.x[i] = static_cast<float>(n.x);
  out.y[i] = static_cast<float>(n.y);
  out.z[i] = static_cast<float>(n.z);
}

/// Value and, if wanted, gradient (per metre of the rotated frame, times amplitude 1) into the arrays.
template <class Real, Wanted kWanted>
void octaveInOneCell(const RotatedBlock& block, const NoiseOctave& octave, const double* first,
                     OctaveSamples<Real>& out) {
  const double inverse = octave.inverseWavelength;
  const double ox = octave.offset[0], oy = octave.offset[1], oz = octave.offset[2];
  const double rx = roundToCell(first[0]), ry = roundToCell(first[1]), rz = roundToCell(first[2]);
  const Cell cell = cellDirections(cellIndex(first[0]), cellIndex(first[1]), cellIndex(first[2]), octave.seed);
  for (std::size_t i = 0; i < block.count; ++i) {
    const Real fx = static_cast<Real>(((block.x[i] * inverse + ox) - rx) + 0.5);
    const Real fy = static_cast<Real>(((block.y[i] * inverse + oy) - ry) + 0.5);
    const Real fz = static_cast<Real>(((block.z[i] * inverse + oz) - rz) + 0.5);
    const Noise<Real> n = noiseInCell<Real>(cell, fx, fy, fz);
    out.value[i] = n.value;
    if constexpr (kWanted == Wanted::All) storeGradient(n, i, out);
  }
}

template <class Real>
TERRANE_INLINE void splitCells(const double* p, std::size_t count, double inverse, double offset, Real* fraction,
                               std::uint32_t* index) {
  for (std::size_t i = 0; i < count; ++i) {
    const double t = p[i] * inverse + offset;
    fraction[i] = static_cast<Real>((t - roundToCell(t)) + 0.5);
    index[i] = cellIndex(t);
  }
}

template <class Real, Wanted kWanted>
void octaveInManyCells(const RotatedBlock& block, const NoiseOctave& octave, OctaveSamples<Real>& out) {
  alignas(64) Real fx[kBlockCapacity], fy[kBlockCapacity], fz[kBlockCapacity];
  alignas(64) std::uint32_t ix[kBlockCapacity], iy[kBlockCapacity], iz[kBlockCapacity];
  const double inverse = octave.inverseWavelength;
  splitCells<Real>(block.x, block.count, inverse, octave.offset[0], fx, ix);
  splitCells<Real>(block.y, block.count, inverse, octave.offset[1], fy, iy);
  splitCells<Real>(block.z, block.count, inverse, octave.offset[2], fz, iz);
  const std::uint32_t seed = octave.seed;
  for (std::size_t i = 0; i < block.count; ++i) {
    const Noise<Real> n = noiseInCell<Real>(cellDirections(ix[i], iy[i], iz[i], seed), fx[i], fy[i], fz[i]);
    out.value[i] = n.value;
    if constexpr (kWanted == Wanted::All) storeGradient(n, i, out);
  }
}

/// Rounding is monotone, so if the corners of the block's box share a cell, all its samples do.
template <class Real, Wanted kWanted>
void evaluateOctave(const RotatedBlock& block, const NoiseOctave& octave, OctaveSamples<Real>& out) {
  double low[3];
  bool oneCell = true;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = block.low[axis] * octave.inverseWavelength + octave.offset[axis];
    const double high = block.high[axis] * octave.inverseWavelength + octave.offset[axis];
    oneCell = oneCell && roundToCell(low[axis]) == roundToCell(high);
  }
  if (oneCell) {
    octaveInOneCell<Real, kWanted>(block, octave, low, out);
  } else {
    octaveInManyCells<Real, kWanted>(block, octave, out);
  }
}

// Spelt out in vectors: compilers do not reorder the comparisons of doubles.
typedef double Lanes __attribute__((vector_size(32), may_alias));

/// Of whole chunks, aligned as the block's arrays are.
TERRANE_INLINE void findExtent(const double* values, std::size_t count, double& least, double& largest) {
  const Lanes* v = reinterpret_cast<const Lanes*>(values);
  Lanes low = v[0], high = v[0];
  for (std::size_t i = 1; i < count / 4; ++i) {
    low = v[i] < low ? v[i] : low;
    high = v[i] > high ? v[i] : high;
  }
  least = low[0];
  largest = high[0];
  for (int j = 1; j < 4; ++j) {
    least = low[j] < least ? low[j] : least;
    largest = high[j] > largest ? high[j] : largest;
  }
}

RotatedBlock rotateBlock(Block& b, const double* m) {
  RotatedBlock r{b.rotatedX, b.rotatedY, b.rotatedZ, b.count, {}, {}};
  for (std::size_t i = 0; i < b.count; ++i) {
    b.rotatedX[i] = (m[0] * b.x[i] + m[1] * b.y[i]) + m[2] * b.z[i];
    b.rotatedY[i] = (m[3] * b.x[i] + m[4] * b.y[i]) + m[5] * b.z[i];
    b.rotatedZ[i] = (m[6] * b.x[i] + m[7] * b.y[i]) + m[8] * b.z[i];
  }
  const double* p[3] = {r.x, r.y, r.z};
  for (int axis = 0; axis < 3; ++axis) findExtent(p[axis], b.count, r.low[axis], r.high[axis]);
  return r;
}

}  // namespace

// Broad relief, basins, lava and regolith noise over one block of samples: part of every build of the lunar kernels.

#include "server/fields/lunar_noise.inl"

namespace {

/// Turns a gradient in a group's frame back to the body's: the rotation's transpose.
TERRANE_INLINE void rotateBack(const float* m, float x, float y, float z, float& bodyX, float& bodyY, float& bodyZ) {
  bodyX = (m[0] * x + m[3] * y) + m[6] * z;
  bodyY = (m[1] * x + m[4] * y) + m[7] * z;
  bodyZ = (m[2] * x + m[5] * y) + m[8] * z;
}

/// Relief and lava are two sums over the same octaves. The last octave is left in `last` as the modulator of the first
/// regolith group.
template <class Real, Wanted kWanted>
void addRelief(const NoiseGroup& group, double footprint, Block& b, OctaveSamples<float>& last) {
  const RotatedBlock rotated = rotateBlock(b, group.rotation);
  float m[9];
  for (int i = 0; i < 9; ++i) m[i] = static_cast<float>(group.rotation[i]);
  OctaveSamples<Real> n;
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    evaluateOctave<Real, kWanted>(rotated, octave, n);
    const double a = octave.amplitude, l = octave.lavaAmplitude;
    const double kept = keptSlope(footprint, octave.inverseWavelength) * octave.inverseWavelength;
    const float da = static_cast<float>(a * kept), dl = static_cast<float>(l * kept);
    const float toUnit = static_cast<float>(octave.inverseWavelength);
    const float weight = k < 2 ? 0.0f : 0.45f;  // mottling from some 250 km down
    for (std::size_t i = 0; i < b.count; ++i) {
      b.relief[i] += a * static_cast<double>(n.value[i]);
      b.lava[i] += l * static_cast<double>(n.value[i]);
      last.value[i] = static_cast<float>(n.value[i]);
      if constexpr (kWanted == Wanted::Heights) continue;
      float gx, gy, gz;
      rotateBack(m, n.x[i], n.y[i], n.z[i], gx, gy, gz);
      b.reliefX[i] += da * gx;
      b.reliefY[i] += da * gy;
      b.reliefZ[i] += da * gz;
      b.lavaX[i] += dl * gx;
      b.lavaY[i] += dl * gy;
      b.lavaZ[i] += dl * gz;
      b.mottle[i] += weight * static_cast<float>(n.value[i]);
      last.x[i] = toUnit * gx;
      last.y[i] = toUnit * gy;
      last.z[i] = toUnit * gz;
    }
  }
}

TERRANE_INLINE bool reaches(const Block& b, const double* center, double reach) {
  const double dx = b.center[0] - center[0], dy = b.center[1] - center[1], dz = b.center[2] - center[2];
  const double limit = reach + b.radius;
  return dx * dx + dy * dy + dz * dz <= limit * limit;
}

template <Wanted kWanted>
void addBasin(const Basin& basin, Block& b) {
  constexpr double kRingHalfWidth = 0.45;
  for (std::size_t i = 0; i < b.count; ++i) {
    const double dx = b.x[i] - basin.center[0], dy = b.y[i] - basin.center[1], dz = b.z[i] - basin.center[2];
    const double u = (dx * dx + dy * dy + dz * dz) * basin.inverseRadiusSquared;
    const double bowl = u < 1.0 ? 1.0 - u * u : 0.0;
    const double r = (u - 1.0) * (1.0 / kRingHalfWidth);
    const double ring = r * r < 1.0 ? 1.0 - r * r : 0.0;
    b.relief[i] += basin.ring * (ring * ring * ring) - basin.depth * (bowl * bowl * bowl);
    if constexpr (kWanted == Wanted::Heights) continue;
    const double slope =
        (6.0 * basin.depth * u * (bowl * bowl) - 6.0 * basin.ring * (ring * ring) * r * (1.0 / kRingHalfWidth)) *
        (2.0 * basin.inverseRadiusSquared);
    b.reliefX[i] += static_cast<float>(slope * dx);
    b.reliefY[i] += static_cast<float>(slope * dy);
    b.reliefZ[i] += static_cast<float>(slope * dz);
  }
}

/// dry = the product of (1 - patch): 1 where no lava may stand.
template <Wanted kWanted>
void addPatch(const LavaPatch& patch, Block& b) {
  for (std::size_t i = 0; i < b.count; ++i) {
    const double dx = b.x[i] - patch.center[0], dy = b.y[i] - patch.center[1], dz = b.z[i] - patch.center[2];
    const double u = (dx * dx + dy * dy + dz * dz) * patch.inverseReachSquared;
    double t = (u - patch.innerSquared) * patch.inverseRamp;
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    const double keep = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    const double before = b.dry[i];
    b.dry[i] *= keep;
    if constexpr (kWanted == Wanted::Heights) continue;
    const double slope =
        before * (30.0 * (t * (1.0 - t)) * (t * (1.0 - t)) * patch.inverseRamp * 2.0 * patch.inverseReachSquared);
    b.dryX[i] = static_cast<float>(b.dryX[i] * keep + slope * dx);
    b.dryY[i] = static_cast<float>(b.dryY[i] * keep + slope * dy);
    b.dryZ[i] = static_cast<float>(b.dryZ[i] * keep + slope * dz);
  }
}

/// scale = 1 + modulation * last; the group's own last octave replaces it.
template <Wanted kWanted>
void addRegolith(const NoiseGroup& group, double footprint, Block& b, OctaveSamples<float>& last) {
  const RotatedBlock rotated = rotateBlock(b, group.rotation);
  float m[9];
  for (int i = 0; i < 9; ++i) m[i] = static_cast<float>(group.rotation[i]);
  OctaveSamples<float> n, sum;
  for (std::size_t i = 0; i < b.count; ++i) sum.value[i] = sum.x[i] = sum.y[i] = sum.z[i] = 0.0f;
  constexpr double kMottle = 0.35;  // an octave; all alike, so that none shows where it enters
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    evaluateOctave<float, kWanted>(rotated, octave, n);
    const double kept = keptSlope(footprint, octave.inverseWavelength);
    const float a = static_cast<float>(octave.amplitude), mottle = static_cast<float>(kMottle * kept);
    const float da = static_cast<float>(octave.amplitude * octave.inverseWavelength * kept);
    for (std::size_t i = 0; i < b.count; ++i) {
      sum.value[i] += a * n.value[i];
      if constexpr (kWanted == Wanted::Heights) continue;
      b.mottle[i] += mottle * n.value[i];
      sum.x[i] += da * n.x[i];
      sum.y[i] += da * n.y[i];
      sum.z[i] += da * n.z[i];
    }
  }
  const NoiseOctave& finest = group.octaves[group.count - 1];
  const float toUnit = static_cast<float>(finest.inverseWavelength);
  const float modulation = static_cast<float>(group.modulation);
  for (std::size_t i = 0; i < b.count; ++i) {
    const float scale = 1.0f + modulation * last.value[i], v = modulation * sum.value[i];
    b.rough[i] += scale * sum.value[i];
    last.value[i] = n.value[i];
    if constexpr (kWanted == Wanted::Heights) continue;
    float gx, gy, gz;
    rotateBack(m, sum.x[i], sum.y[i], sum.z[i], gx, gy, gz);
    b.roughX[i] += scale * gx + v * last.x[i];
    b.roughY[i] += scale * gy + v * last.y[i];
    b.roughZ[i] += scale * gz + v * last.z[i];
    rotateBack(m, toUnit * n.x[i], toUnit * n.y[i], toUnit * n.z[i], last.x[i], last.y[i], last.z[i]);
  }
}

}  // namespace

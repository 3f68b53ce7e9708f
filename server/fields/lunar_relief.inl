// Broad relief, basins, lava and regolith noise over one block of samples: part of every build of the lunar kernels.

#include "server/fields/lunar_noise.inl"

namespace {

/// Turns a gradient in a group's frame back to the body's: the rotation's transpose.
TERRANE_INLINE void rotateBack(const float* m, float x, float y, float z, float& bodyX, float& bodyY, float& bodyZ) {
  bodyX = (m[0] * x + m[3] * y) + m[6] * z;
  bodyY = (m[1] * x + m[4] * y) + m[7] * z;
  bodyZ = (m[2] * x + m[5] * y) + m[8] * z;
}

struct Rotation {
  float m[9];
  explicit Rotation(const NoiseGroup& group) {
    for (int i = 0; i < 9; ++i) m[i] = static_cast<float>(group.rotation[i]);
  }
};

template <class Real, Wanted kWanted>
void addReliefOctave(const NoiseOctave& octave, const RotatedBlock& rotated, const Rotation& turn, double footprint,
                     bool withLava, bool isLast, Block& b) {
  OctaveSamples<Real> n;
  evaluateOctave<Real, kWanted>(rotated, octave, n);
  const double a = octave.amplitude, l = octave.lavaAmplitude;
  const double kept = keptSlope(footprint, octave.inverseWavelength) * octave.inverseWavelength;
  const float da = static_cast<float>(a * kept), dl = static_cast<float>(l * kept);
  const float weight = static_cast<float>(octave.mottle);
  for (std::size_t i = 0; i < b.count; ++i) {
    b.relief[i] += a * static_cast<double>(n.value[i]);
    if constexpr (kWanted == Wanted::Heights) continue;
    rotateBack(turn.m, n.x[i], n.y[i], n.z[i], n.x[i], n.y[i], n.z[i]);
    b.reliefX[i] += da * n.x[i];
    b.reliefY[i] += da * n.y[i];
    b.reliefZ[i] += da * n.z[i];
    b.mottle[i] += weight * static_cast<float>(n.value[i]);
  }
  for (std::size_t i = 0; withLava && i < b.count; ++i) {
    b.lava[i] += l * static_cast<double>(n.value[i]);
    if constexpr (kWanted == Wanted::Heights) continue;
    b.lavaX[i] += dl * n.x[i];
    b.lavaY[i] += dl * n.y[i];
    b.lavaZ[i] += dl * n.z[i];
  }
  if (!isLast) return;
  const float toUnit = static_cast<float>(octave.inverseWavelength);
  for (std::size_t i = 0; i < b.count; ++i) {
    b.last[i] = static_cast<double>(n.value[i]);
    if constexpr (kWanted == Wanted::Heights) continue;
    b.lastX[i] = toUnit * n.x[i];
    b.lastY[i] = toUnit * n.y[i];
    b.lastZ[i] = toUnit * n.z[i];
  }
}

TERRANE_INLINE bool inDouble(const NoiseOctave& octave, const Program& program) {
  return program.doubleWavelength * octave.inverseWavelength <= 1;
}

/// Added to an expansion of ground that is not mixed (far_expansion.h).
TERRANE_INLINE bool isPlain(const Program& program) {
  return program.far != nullptr && program.far->ground != FarGround::Mixed;
}

/// Relief and lava are two sums over the same octaves. The last octave is left as the modulator of the first regolith
/// group.
template <Wanted kWanted>
void addRelief(const Program& program, Block& b) {
  const NoiseGroup& group = program.relief;
  if (group.count == 0) return;
  const RotatedBlock rotated = rotateBlock(b, group.rotation);
  const Rotation turn(group);
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    if (inDouble(octave, program)) {
      addReliefOctave<double, kWanted>(octave, rotated, turn, program.footprint, !isPlain(program),
                                       k + 1 == group.count, b);
    } else {
      addReliefOctave<float, kWanted>(octave, rotated, turn, program.footprint, !isPlain(program), k + 1 == group.count,
                                      b);
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
  for (std::size_t i = 0; i < b.count; ++i) {
    const double dx = b.x[i] - basin.center[0], dy = b.y[i] - basin.center[1], dz = b.z[i] - basin.center[2];
    const double u = (dx * dx + dy * dy + dz * dz) * basin.inverseRadiusSquared;
    const double bowl = u < 1.0 ? 1.0 - u * u : 0.0;
    const double r = (u - 1.0) * (1.0 / kBasinRingHalfWidth);
    const double ring = r * r < 1.0 ? 1.0 - r * r : 0.0;
    b.relief[i] += basin.ring * (ring * ring * ring) - basin.depth * (bowl * bowl * bowl);
    if constexpr (kWanted == Wanted::Heights) continue;
    const double slope =
        (6.0 * basin.depth * u * (bowl * bowl) - 6.0 * basin.ring * (ring * ring) * r * (1.0 / kBasinRingHalfWidth)) *
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

template <class Real, Wanted kWanted>
void addRegolithOctave(const NoiseOctave& octave, const RotatedBlock& rotated, double footprint, Block& b,
                       OctaveSamples<double>* finest) {
  OctaveSamples<Real> n;
  evaluateOctave<Real, kWanted>(rotated, octave, n);
  const double kept = keptSlope(footprint, octave.inverseWavelength), a = octave.amplitude;
  const float mottle = static_cast<float>(octave.mottle * kept);
  const float da = static_cast<float>(octave.amplitude * octave.inverseWavelength * kept);
  for (std::size_t i = 0; i < b.count; ++i) {
    b.sum[i] += a * static_cast<double>(n.value[i]);
    if constexpr (kWanted == Wanted::Heights) continue;
    b.mottle[i] += mottle * static_cast<float>(n.value[i]);
    b.sumX[i] += da * n.x[i];
    b.sumY[i] += da * n.y[i];
    b.sumZ[i] += da * n.z[i];
  }
  if (finest == nullptr) return;
  const float toUnit = static_cast<float>(octave.inverseWavelength);
  for (std::size_t i = 0; i < b.count; ++i) {
    finest->value[i] = static_cast<double>(n.value[i]);
    if constexpr (kWanted == Wanted::Heights) continue;
    finest->x[i] = toUnit * n.x[i];
    finest->y[i] = toUnit * n.y[i];
    finest->z[i] = toUnit * n.z[i];
  }
}

/// rough += (1 + modulation * last) * sum; the group's own last octave replaces the last.
template <Wanted kWanted>
void scaleAndAdd(const NoiseGroup& group, const OctaveSamples<double>& finest, Block& b) {
  const Rotation turn(group);
  for (std::size_t i = 0; i < b.count; ++i) {
    const double scale = 1.0 + group.modulation * b.last[i], v = group.modulation * b.sum[i];
    b.rough[i] += scale * b.sum[i];
    b.last[i] = finest.value[i];
    if constexpr (kWanted == Wanted::Heights) continue;
    const float s = static_cast<float>(scale), t = static_cast<float>(v);
    float gx, gy, gz;
    rotateBack(turn.m, b.sumX[i], b.sumY[i], b.sumZ[i], gx, gy, gz);
    b.roughX[i] += s * gx + t * b.lastX[i];
    b.roughY[i] += s * gy + t * b.lastY[i];
    b.roughZ[i] += s * gz + t * b.lastZ[i];
    rotateBack(turn.m, finest.x[i], finest.y[i], finest.z[i], b.lastX[i], b.lastY[i], b.lastZ[i]);
  }
}

/// The far part of a group is left unscaled, for its near part to start from.
template <Wanted kWanted>
void addRegolith(const NoiseGroup& group, const Program& program, Block& b) {
  const RotatedBlock rotated = rotateBlock(b, group.rotation);
  if (group.part != GroupPart::Near)
    for (std::size_t i = 0; i < b.count; ++i) b.sum[i] = b.sumX[i] = b.sumY[i] = b.sumZ[i] = 0;
  OctaveSamples<double> finest;
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    OctaveSamples<double>* const kept = k + 1 == group.count ? &finest : nullptr;
    if (inDouble(octave, program)) {
      addRegolithOctave<double, kWanted>(octave, rotated, program.footprint, b, kept);
    } else {
      addRegolithOctave<float, kWanted>(octave, rotated, program.footprint, b, kept);
    }
  }
  if (group.part != GroupPart::Far) scaleAndAdd<kWanted>(group, finest, b);
}

}  // namespace

// The lunar height field over one block of samples: part of every build of the lunar kernels. See lunar_field.h for the
// model. Included after lunar_program.h and with kEvaluate naming the entry.

#include "server/fields/lunar_noise.inl"

namespace {

/// max(a, b) with a rounded (C2) edge of half-width blend: value and the weight of a.
struct Blend {
  double value, weight;
};
TERRANE_INLINE Blend roundedMax(double a, double b, double blend) {
  const double difference = a - b;
  const double distance = difference < 0 ? -difference : difference;
  const double inside = 1.0 - distance / blend;
  const double t = inside > 0 ? inside : 0.0;
  const double larger = difference < 0 ? b : a;
  const double half = 0.5 * (t * t);
  return {larger + blend * (1.0 / 6.0) * (t * t * t), difference < 0 ? half : 1.0 - half};
}

/// What is left of a wave's slope when it is averaged over +-footprint: sin(pi u) / (pi u) with u = 2 footprint /
/// wavelength, by the first factors of its product.
TERRANE_INLINE double keptSlope(double footprint, double inverseWavelength) {
  const double u = 2.0 * footprint * inverseWavelength, square = u * u;
  return square < 1.0 ? (1.0 - square) * (1.0 - 0.25 * square) : 0.0;
}

// ------------------------------------------------------------------------------------------------------------ relief
// and lava

void clearBlock(Block& b) {
  for (std::size_t i = 0; i < b.count; ++i) {
    b.relief[i] = b.lava[i] = b.young[i] = 0.0;
    b.dry[i] = 1.0;
    b.reliefX[i] = b.reliefY[i] = b.reliefZ[i] = b.lavaX[i] = b.lavaY[i] = b.lavaZ[i] = 0.0f;
    b.dryX[i] = b.dryY[i] = b.dryZ[i] = b.youngX[i] = b.youngY[i] = b.youngZ[i] = 0.0f;
    b.rough[i] = b.roughX[i] = b.roughY[i] = b.roughZ[i] = b.bright[i] = b.mottle[i] = 0.0f;
  }
}

/// Turns a gradient in a group's frame back to the body's: the rotation's transpose.
TERRANE_INLINE void rotateBack(const float* m, float x, float y, float z, float& bodyX, float& bodyY, float& bodyZ) {
  bodyX = (m[0] * x + m[3] * y) + m[6] * z;
  bodyY = (m[1] * x + m[4] * y) + m[7] * z;
  bodyZ = (m[2] * x + m[5] * y) + m[8] * z;
}

/// Relief and lava are two sums over the same octaves. The last octave is left in `last` as the modulator of the first
/// regolith group.
template <class Real>
void addRelief(const NoiseGroup& group, double footprint, Block& b, OctaveSamples<float>& last) {
  const RotatedBlock rotated = rotateBlock(b, group.rotation);
  float m[9];
  for (int i = 0; i < 9; ++i) m[i] = static_cast<float>(group.rotation[i]);
  OctaveSamples<Real> n;
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    evaluateOctave<Real>(rotated, octave, n);
    const double a = octave.amplitude, l = octave.lavaAmplitude;
    const double kept = keptSlope(footprint, octave.inverseWavelength) * octave.inverseWavelength;
    const float da = static_cast<float>(a * kept), dl = static_cast<float>(l * kept);
    const float toUnit = static_cast<float>(octave.inverseWavelength);
    const float weight = k < 2 ? 0.0f : 0.45f;  // mottling from some 250 km down
    for (std::size_t i = 0; i < b.count; ++i) {
      float gx, gy, gz;
      rotateBack(m, n.x[i], n.y[i], n.z[i], gx, gy, gz);
      b.relief[i] += a * static_cast<double>(n.value[i]);
      b.reliefX[i] += da * gx;
      b.reliefY[i] += da * gy;
      b.reliefZ[i] += da * gz;
      b.lava[i] += l * static_cast<double>(n.value[i]);
      b.lavaX[i] += dl * gx;
      b.lavaY[i] += dl * gy;
      b.lavaZ[i] += dl * gz;
      b.mottle[i] += weight * static_cast<float>(n.value[i]);
      last.value[i] = static_cast<float>(n.value[i]);
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

void addBasin(const Basin& basin, Block& b) {
  constexpr double kRingHalfWidth = 0.45;
  for (std::size_t i = 0; i < b.count; ++i) {
    const double dx = b.x[i] - basin.center[0], dy = b.y[i] - basin.center[1], dz = b.z[i] - basin.center[2];
    const double u = (dx * dx + dy * dy + dz * dz) * basin.inverseRadiusSquared;
    const double bowl = u < 1.0 ? 1.0 - u * u : 0.0;
    const double r = (u - 1.0) * (1.0 / kRingHalfWidth);
    const double ring = r * r < 1.0 ? 1.0 - r * r : 0.0;
    b.relief[i] += basin.ring * (ring * ring * ring) - basin.depth * (bowl * bowl * bowl);
    const double slope =
        (6.0 * basin.depth * u * (bowl * bowl) - 6.0 * basin.ring * (ring * ring) * r * (1.0 / kRingHalfWidth)) *
        (2.0 * basin.inverseRadiusSquared);
    b.reliefX[i] += static_cast<float>(slope * dx);
    b.reliefY[i] += static_cast<float>(slope * dy);
    b.reliefZ[i] += static_cast<float>(slope * dz);
  }
}

/// dry = the product of (1 - patch): 1 where no lava may stand.
void addPatch(const LavaPatch& patch, Block& b) {
  for (std::size_t i = 0; i < b.count; ++i) {
    const double dx = b.x[i] - patch.center[0], dy = b.y[i] - patch.center[1], dz = b.z[i] - patch.center[2];
    const double u = (dx * dx + dy * dy + dz * dz) * patch.inverseReachSquared;
    double t = (u - patch.innerSquared) * patch.inverseRamp;
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    const double keep = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    const double slope =
        b.dry[i] * (30.0 * (t * (1.0 - t)) * (t * (1.0 - t)) * patch.inverseRamp * 2.0 * patch.inverseReachSquared);
    b.dryX[i] = static_cast<float>(b.dryX[i] * keep + slope * dx);
    b.dryY[i] = static_cast<float>(b.dryY[i] * keep + slope * dy);
    b.dryZ[i] = static_cast<float>(b.dryZ[i] * keep + slope * dz);
    b.dry[i] *= keep;
  }
}

// -------------------------------------------------------------------------------------------------------------
// regolith noise

/// scale = 1 + modulation * last; the group's own last octave replaces it.
void addRegolith(const NoiseGroup& group, double footprint, Block& b, OctaveSamples<float>& last) {
  const RotatedBlock rotated = rotateBlock(b, group.rotation);
  float m[9];
  for (int i = 0; i < 9; ++i) m[i] = static_cast<float>(group.rotation[i]);
  OctaveSamples<float> n, sum;
  for (std::size_t i = 0; i < b.count; ++i) sum.value[i] = sum.x[i] = sum.y[i] = sum.z[i] = 0.0f;
  constexpr double kMottle = 0.35;  // an octave; all alike, so that none shows where it enters
  for (std::size_t k = 0; k < group.count; ++k) {
    const NoiseOctave& octave = group.octaves[k];
    evaluateOctave<float>(rotated, octave, n);
    const double kept = keptSlope(footprint, octave.inverseWavelength);
    const float a = static_cast<float>(octave.amplitude), mottle = static_cast<float>(kMottle * kept);
    const float da = static_cast<float>(octave.amplitude * octave.inverseWavelength * kept);
    for (std::size_t i = 0; i < b.count; ++i) {
      sum.value[i] += a * n.value[i];
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
    float gx, gy, gz;
    rotateBack(m, sum.x[i], sum.y[i], sum.z[i], gx, gy, gz);
    const float scale = 1.0f + modulation * last.value[i], v = modulation * sum.value[i];
    b.rough[i] += scale * sum.value[i];
    b.roughX[i] += scale * gx + v * last.x[i];
    b.roughY[i] += scale * gy + v * last.y[i];
    b.roughZ[i] += scale * gz + v * last.z[i];
    last.value[i] = n.value[i];
    rotateBack(m, toUnit * n.x[i], toUnit * n.y[i], toUnit * n.z[i], last.x[i], last.y[i], last.z[i]);
  }
}

// ------------------------------------------------------------------------------------------------------------ craters,
// rocks

template <class Real>
TERRANE_INLINE Real squareRoot(Real v);
template <>
TERRANE_INLINE float squareRoot(float v) {
  return __builtin_sqrtf(v);
}
template <>
TERRANE_INLINE double squareRoot(double v) {
  return __builtin_sqrt(v);
}

template <class Real>
struct Profile {
  Real value, slope;  ///< metres; its derivative by s = (distance / radius)^2
};

template <class Real>
struct Shape {
  Real apex, rise, floor, floorBlend, inverseFloorBlend, rim, rimBlend, inverseRimBlend, peak;
  /// For slopes: the inverse half-widths of the edges, rounded at least to the footprint; and what it leaves of a
  /// slope.
  Real inverseSoftFloor, inverseSoftRim, keptSlope;
};

template <class Real>
Shape<Real> shapeOf(const Feature& f, double footprint) {
  const double reach = footprint / f.radius;
  const double floorRise = f.floor - f.apex;  // the bowl meets the floor where rise s = floorRise
  const double floorSlope = 2.0 * __builtin_sqrt((floorRise > 0 ? floorRise : 0.0) * f.rise);
  const double rimSlope = 2.0 * f.rise + f.rim * (3.0 / (kApronRadii - 1.0));
  const double softFloor = floorSlope * reach, softRim = rimSlope * reach;
  return {Real(f.apex),
          Real(f.rise),
          Real(f.floor),
          Real(f.floorBlend),
          Real(1.0 / f.floorBlend),
          Real(f.rim),
          Real(f.rimBlend),
          Real(1.0 / f.rimBlend),
          Real(f.peak),
          Real(1.0 / (softFloor > f.floorBlend ? softFloor : f.floorBlend)),
          Real(1.0 / (softRim > f.rimBlend ? softRim : f.rimBlend)),
          Real(keptSlope(footprint, 0.5 / f.radius))};
}

/// Bowl, flattened below by a floor, cut above by the apron of ejecta: roundedMin(roundedMax(bowl, floor), apron) +
/// peak. Beyond kApronRadii the apron is 0 and the bowl far above it: exactly 0.
template <class Real>
TERRANE_INLINE Profile<Real> craterProfile(const Shape<Real>& p, Real s) {
  const Real zero(0), one(1), half(0.5), sixth = Real(1.0 / 6.0);
  const Real bowl = p.apex + p.rise * s;
  const Real above = bowl - p.floor;
  const Real aboveSize = above < zero ? -above : above;
  Real t = one - aboveSize * p.inverseFloorBlend;
  t = t > zero ? t : zero;
  Real inner = (above < zero ? p.floor : bowl) + p.floorBlend * sixth * (t * t * t);
  Real tSoft = one - aboveSize * p.inverseSoftFloor;
  tSoft = tSoft > zero ? tSoft : zero;
  const Real bowlWeight = above < zero ? half * (tSoft * tSoft) : one - half * (tSoft * tSoft);
  Real innerSlope = bowlWeight * p.rise;

  const Real peakRest = one - s * Real(1.0 / kPeakRadiusSquared);
  const Real q = peakRest > zero ? peakRest : zero;
  inner += p.peak * (q * q * q);
  innerSlope -= p.peak * Real(3.0 / kPeakRadiusSquared) * (q * q);

  const Real distance = squareRoot<Real>(s + Real(1e-12));
  const Real rest = (Real(kApronRadii) - distance) * Real(1.0 / (kApronRadii - 1.0));
  const Real a = rest > zero ? rest : zero;
  const Real apron = p.rim * (a * a * a);
  const Real apronSlope = p.rim * (a * a) * Real(-1.5 / (kApronRadii - 1.0)) / distance;

  const Real difference = inner - apron;
  const Real size = difference < zero ? -difference : difference;
  Real r = one - size * p.inverseRimBlend;
  r = r > zero ? r : zero;
  Real rSoft = one - size * p.inverseSoftRim;
  rSoft = rSoft > zero ? rSoft : zero;
  const Real innerWeight = difference < zero ? one - half * (rSoft * rSoft) : half * (rSoft * rSoft);
  return {(difference < zero ? inner : apron) - p.rimBlend * sixth * (r * r * r),
          (innerWeight * innerSlope + (one - innerWeight) * apronSlope) * p.keptSlope};
}

/// A boulder: height (1 - s^2)^2, steep sides, rounded top.
template <class Real>
TERRANE_INLINE Profile<Real> rockProfile(const Shape<Real>& p, Real s) {
  const Real rest = Real(1) - s * s;
  const Real q = rest > Real(0) ? rest : Real(0);
  return {p.peak * (q * q), p.peak * (Real(-4) * s) * q * p.keptSlope};
}

/// The stage is a compile-time choice so that the compiler sees which arrays of the block are written, and vectorises.
template <class Real, FeatureStage Stage>
TERRANE_INLINE void addFeatureToChunk(const Feature& f, const Shape<Real>& shape, Block& b, std::size_t begin) {
  constexpr bool kRock = Stage == FeatureStage::Rock, kOld = Stage == FeatureStage::OldCrater;
  const double cx = f.center[0], cy = f.center[1], cz = f.center[2];
  const Real ax = Real(f.axis1[0]), ay = Real(f.axis1[1]), az = Real(f.axis1[2]);
  const Real bx = Real(f.axis2[0]), by = Real(f.axis2[1]), bz = Real(f.axis2[2]);
  const Real inverse = Real(1.0 / f.radius), inverseSquared = inverse * inverse;
  Real lobeCos[kLobes], lobeSin[kLobes];
  for (int k = 0; k < kLobes; ++k) {
    lobeCos[k] = Real(f.lobeCos[k]);
    lobeSin[k] = Real(f.lobeSin[k]);
  }
  const float brightness = f.brightness, inverseHalo = f.inverseHaloSquared, rays = f.rays;
  for (std::size_t i = begin; i < begin + kChunk; ++i) {
    const Real dx = static_cast<Real>(b.x[i] - cx), dy = static_cast<Real>(b.y[i] - cy),
               dz = static_cast<Real>(b.z[i] - cz);
    const Real square = (dx * dx + dy * dy + dz * dz) * inverseSquared;
    const Real along = (dx * ax + dy * ay + dz * az) * inverse, across = (dx * bx + dy * by + dz * bz) * inverse;
    const Real inverseRange = Real(1) / squareRoot<Real>(along * along + across * across + Real(1e-12));
    const Real c = along * inverseRange, s = across * inverseRange;

    // The outline: 1 + sum of cos and sin of 2..5 times the bearing.
    Real cosine = c, sine = s, lobes = Real(0), turn = Real(0);
    for (int k = 0; k < kLobes; ++k) {
      const Real nextCosine = cosine * c - sine * s;
      sine = cosine * s + sine * c;
      cosine = nextCosine;
      lobes += lobeCos[k] * cosine + lobeSin[k] * sine;
      turn += Real(k + 2) * (lobeSin[k] * cosine - lobeCos[k] * sine);
    }
    const Real outline = Real(1) + lobes;
    const Real stretched = square * outline * outline;
    const Profile<Real> h = kRock ? rockProfile<Real>(shape, stretched) : craterProfile<Real>(shape, stretched);

    const Real radial = h.slope * Real(2) * outline * outline * inverseSquared;
    const Real angular = h.slope * Real(2) * square * outline * turn * inverseRange * inverse;
    (kOld ? b.relief : b.young)[i] += static_cast<double>(h.value);
    (kOld ? b.reliefX : b.youngX)[i] += static_cast<float>(radial * dx + angular * (c * bx - s * ax));
    (kOld ? b.reliefY : b.youngY)[i] += static_cast<float>(radial * dy + angular * (c * by - s * ay));
    (kOld ? b.reliefZ : b.youngZ)[i] += static_cast<float>(radial * dz + angular * (c * bz - s * az));

    // The halo's rays lean on the last lobe (order 5).
    const float rest = 1.0f - static_cast<float>(square) * inverseHalo;
    const float halo = rest > 0.0f ? rest : 0.0f;
    b.bright[i] +=
        brightness * (halo * halo) * (1.0f + rays * static_cast<float>(cosine * (square / (square + Real(2)))));
  }
}

template <class Real, FeatureStage Stage>
void addFeatures(const FeatureRun& run, double footprint, Block& b) {
  for (std::size_t k = 0; k < run.count; ++k) {
    const Feature& f = run.features[k];
    if (!reaches(b, f.center, f.reach)) continue;
    const Shape<Real> shape = shapeOf<Real>(f, footprint);
    for (std::size_t chunk = 0; chunk * kChunk < b.count; ++chunk) {
      const double* q = b.chunkCenter[chunk];
      const double dx = q[0] - f.center[0], dy = q[1] - f.center[1], dz = q[2] - f.center[2];
      const double limit = f.reach + b.chunkRadius[chunk];
      if (dx * dx + dy * dy + dz * dz > limit * limit) continue;
      addFeatureToChunk<Real, Stage>(f, shape, b, chunk * kChunk);
    }
  }
}

void addRun(const FeatureRun& run, double footprint, Block& b) {
  switch (run.stage) {
    case FeatureStage::OldCrater:
      return run.inDouble ? addFeatures<double, FeatureStage::OldCrater>(run, footprint, b)
                          : addFeatures<float, FeatureStage::OldCrater>(run, footprint, b);
    case FeatureStage::YoungCrater:
      return run.inDouble ? addFeatures<double, FeatureStage::YoungCrater>(run, footprint, b)
                          : addFeatures<float, FeatureStage::YoungCrater>(run, footprint, b);
    case FeatureStage::Rock:
      return addFeatures<float, FeatureStage::Rock>(run, footprint, b);
  }
}

/// Streaks: the sum of three waves of orders 6, 11 and 17, sharpened, broken up by mottling, faded with distance.
/// Reflectance only.
void addRays(const RaySystem& system, Block& b) {
  for (std::size_t i = 0; i < b.count; ++i) {
    const double px = b.x[i] - system.center[0], py = b.y[i] - system.center[1], pz = b.z[i] - system.center[2];
    const float square =
        static_cast<float>((px * px + py * py + pz * pz) * (system.inverseRadius * system.inverseRadius));
    const float along = static_cast<float>(px * system.axis1[0] + py * system.axis1[1] + pz * system.axis1[2]);
    const float across = static_cast<float>(px * system.axis2[0] + py * system.axis2[1] + pz * system.axis2[2]);
    const float inverseRange = 1.0f / __builtin_sqrtf(along * along + across * across + 1e-12f);
    const float c = along * inverseRange, s = across * inverseRange;
    const float c2 = c * c - s * s, s2 = 2.0f * c * s;
    const float c3 = c2 * c - s2 * s, s3 = c2 * s + s2 * c;
    const float c5 = c3 * c2 - s3 * s2, s5 = c3 * s2 + s3 * c2;
    const float c6 = c3 * c3 - s3 * s3, s6 = 2.0f * c3 * s3;
    const float c11 = c5 * c6 - s5 * s6, s11 = c5 * s6 + s5 * c6;
    const float c17 = c11 * c6 - s11 * s6, s17 = c11 * s6 + s11 * c6;
    const float* p = system.phase;
    const float wave = (p[0] * c6 + p[1] * s6) + (p[2] * c11 + p[3] * s11) + (p[4] * c17 + p[5] * s17);
    const float crest = 0.5f * wave - 0.22f + 0.8f * b.mottle[i];
    const float streak = crest > 0.0f ? crest : 0.0f;
    const float distance = __builtin_sqrtf(square);
    const float rest = 1.0f - distance * system.inverseReachInRadii;
    const float fade = rest > 0.0f ? rest : 0.0f;
    const float near = 1.0f - distance * 0.22f;
    const float halo = near > 0.0f ? near : 0.0f;
    b.bright[i] += system.strength * ((fade * fade) * (streak < 1.0f ? streak : 1.0f) + halo * halo);
  }
}

// ----------------------------------------------------------------------------------------------------------------
// composition

/// How much of what is around a sample is land: roundedMax's weight, over a blend at least as wide as the footprint, so
/// that coasts are not cut in steps of cells.
TERRANE_INLINE float landShare(float height, float slopeX, float slopeY, float slopeZ, float blend, float footprint) {
  const float slope = __builtin_sqrtf((slopeX * slopeX + slopeY * slopeY) + slopeZ * slopeZ);
  const float wide = 1.5f * footprint * slope;
  const float inside = 1.0f - (height < 0 ? -height : height) / (wide > blend ? wide : blend);
  const float t = inside > 0 ? inside : 0.0f;
  const float half = 0.5f * (t * t);
  return height < 0 ? half : 1.0f - half;
}

/// Floods the relief, adds what is young, clamps (C2, so that no sum of overlapping features leaves the stated range),
/// roughens.
void composeHeight(const Program& p, Block& b) {
  const float smoothing = static_cast<float>(p.mareSmoothing);
  const float lavaRise = static_cast<float>(p.lavaTop - p.lavaFloor);
  const float lavaTint = static_cast<float>(3.0 * p.inverseReliefAmplitude);
  const double inverseRadius = 1.0 / p.radius;
  const float lavaBlend = static_cast<float>(p.lavaBlend), footprint = static_cast<float>(p.footprint);
  for (std::size_t i = 0; i < b.count; ++i) {
    const double lava = p.lavaTop - (p.lavaTop - p.lavaFloor) * b.dry[i] + b.lava[i];
    const Blend surface = roundedMax(b.relief[i], lava, p.lavaBlend);
    const Blend bottom = roundedMax(surface.value + b.young[i], p.clampLow, p.clampBlend);
    const Blend top = roundedMax(-bottom.value, -p.clampHigh, p.clampBlend);
    const float keep = static_cast<float>(bottom.weight * top.weight);
    const float lavaX = b.lavaX[i] - lavaRise * b.dryX[i], lavaY = b.lavaY[i] - lavaRise * b.dryY[i],
                lavaZ = b.lavaZ[i] - lavaRise * b.dryZ[i];
    const float land = landShare(static_cast<float>(b.relief[i] - lava), b.reliefX[i] - lavaX, b.reliefY[i] - lavaY,
                                 b.reliefZ[i] - lavaZ, lavaBlend, footprint);
    const float mare = keep * (1.0f - land), landKeep = land * keep;

    const float dry = static_cast<float>(b.dry[i]);
    const float calm = 1.0f - smoothing * (1.0f - dry), roughCalm = smoothing * b.rough[i];
    b.height[i] = static_cast<double>(calm * b.rough[i]) - top.value;

    float gx = landKeep * b.reliefX[i] + mare * lavaX + keep * b.youngX[i];
    float gy = landKeep * b.reliefY[i] + mare * lavaY + keep * b.youngY[i];
    float gz = landKeep * b.reliefZ[i] + mare * lavaZ + keep * b.youngZ[i];
    gx += calm * b.roughX[i] + roughCalm * b.dryX[i];
    gy += calm * b.roughY[i] + roughCalm * b.dryY[i];
    gz += calm * b.roughZ[i] + roughCalm * b.dryZ[i];
    const float nx = static_cast<float>(b.x[i] * inverseRadius), ny = static_cast<float>(b.y[i] * inverseRadius),
                nz = static_cast<float>(b.z[i] * inverseRadius);
    const float outward = (gx * nx + gy * ny) + gz * nz;
    gx -= outward * nx;
    gy -= outward * ny;
    gz -= outward * nz;
    b.gradientX[i] = gx;
    b.gradientY[i] = gy;
    b.gradientZ[i] = gz;

    // Reflectance: dark lava, bright highlands, brighter where slopes or youth expose fresh material.
    const float squareSlope = (gx * gx + gy * gy) + gz * gz;
    const float steep = squareSlope / (squareSlope + 0.5f);
    const float uplift = static_cast<float>(b.relief[i] * p.inverseReliefAmplitude);
    const float highland = 0.138f + 0.012f * uplift,
                basalt = 0.055f + 0.004f * static_cast<float>(b.lava[i]) * lavaTint;
    const float mottling = 1.0f + 0.10f * b.mottle[i] + 0.35f * steep;
    const float tint = (basalt + land * (highland - basalt)) * mottling + b.bright[i];
    b.reflectance[i] = tint < 0.03f ? 0.03f : tint > 0.38f ? 0.38f : tint;
  }
}

}  // namespace

void kEvaluate(const Program& program, Block& block) noexcept {
  clearBlock(block);
  OctaveSamples<float> modulator;
  for (std::size_t i = 0; i < block.count; ++i)
    modulator.value[i] = modulator.x[i] = modulator.y[i] = modulator.z[i] = 0.0f;
  if (program.reliefInDouble) {
    addRelief<double>(program.relief, program.footprint, block, modulator);
  } else {
    addRelief<float>(program.relief, program.footprint, block, modulator);
  }
  for (std::size_t k = 0; k < program.basinCount; ++k) {
    if (reaches(block, program.basins[k].center, program.basins[k].reach)) addBasin(program.basins[k], block);
  }
  for (std::size_t k = 0; k < program.patchCount; ++k) {
    if (reaches(block, program.patches[k].center, program.patches[k].reach)) addPatch(program.patches[k], block);
  }
  for (std::size_t k = 0; k < program.regolithCount; ++k)
    addRegolith(program.regolith[k], program.footprint, block, modulator);
  for (std::size_t k = 0; k < program.runCount; ++k) addRun(program.runs[k], program.footprint, block);
  for (std::size_t k = 0; k < program.rayCount; ++k) {
    if (reaches(block, program.rays[k].center, program.rays[k].reach)) addRays(program.rays[k], block);
  }
  composeHeight(program, block);
}

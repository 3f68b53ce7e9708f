// Craters, rocks and rays over one block of samples: part of every build of the lunar kernels.

#include "server/fields/lunar_relief.inl"

namespace {

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
  /// For slopes: the inverse half-widths of the edges, rounded at least to the footprint; and what it and the level
  /// leave of a slope.
  Real inverseSoftFloor, inverseSoftRim, keptSlope;
  Real shown;      ///< share of the height
  Real steepness;  ///< of a rock
};

template <class Real>
Shape<Real> shapeOf(const Feature& f, const Program& program) {
  const double reach = program.footprint / f.radius;
  const double floorRise = f.floor - f.apex;  // the bowl meets the floor where rise s = floorRise
  const double floorSlope = 2.0 * __builtin_sqrt((floorRise > 0 ? floorRise : 0.0) * f.rise);
  const double rimSlope = 2.0 * f.rise + f.rim * (3.0 / (kApronRadii - 1.0));
  const double shown = shownShare(f.radius, program.minWavelength);
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
          Real(shown * keptSlope(program.footprint, 0.5 / f.radius)),
          Real(shown),
          Real(rockSteepness(f.radius, program.minWavelength))};
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
  return {((difference < zero ? inner : apron) - p.rimBlend * sixth * (r * r * r)) * p.shown,
          (innerWeight * innerSlope + (one - innerWeight) * apronSlope) * p.keptSlope};
}

/// A boulder, steep sides and rounded top, or as much of one as a level shows: see rockSteepness.
template <class Real>
TERRANE_INLINE Profile<Real> rockProfile(const Shape<Real>& p, Real s) {
  const Real zero(0), rest = Real(1) - s * s, toRim = Real(1) - s;
  const Real q = rest > zero ? rest : zero, d = toRim > zero ? toRim : zero;
  const Real dome = d * d, domeSlope = Real(-2) * d, steepSlope = Real(-4) * s * q;
  return {p.peak * (dome + p.steepness * (q * q - dome)) * p.shown,
          p.peak * (domeSlope + p.steepness * (steepSlope - domeSlope)) * p.keptSlope};
}

/// The stage is a compile-time choice so that the compiler sees which arrays of the block are written, and vectorises.
template <class Real, FeatureStage Stage, Wanted kWanted>
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
  const float brightness = f.brightness * static_cast<float>(shape.shown);
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

    (kOld ? b.relief : b.young)[i] += static_cast<double>(h.value);
    if constexpr (kWanted == Wanted::Heights) continue;
    const Real radial = h.slope * Real(2) * outline * outline * inverseSquared;
    const Real angular = h.slope * Real(2) * square * outline * turn * inverseRange * inverse;
    (kOld ? b.reliefX : b.youngX)[i] += static_cast<float>(radial * dx + angular * (c * bx - s * ax));
    (kOld ? b.reliefY : b.youngY)[i] += static_cast<float>(radial * dy + angular * (c * by - s * ay));
    (kOld ? b.reliefZ : b.youngZ)[i] += static_cast<float>(radial * dz + angular * (c * bz - s * az));

    if constexpr (kRock) {
      const float rest = 1.0f - static_cast<float>(square);
      const float inside = rest > 0.0f ? rest : 0.0f;
      b.bright[i] += brightness * (inside * inside);
    }
  }
}

/// Whether a feature that ends at reach from its centre touches a chunk.
TERRANE_INLINE bool chunkReaches(const Block& b, std::size_t chunk, const double* center, double reach) {
  const double* q = b.chunkCenter[chunk];
  const double dx = q[0] - center[0], dy = q[1] - center[1], dz = q[2] - center[2];
  const double limit = reach + b.chunkRadius[chunk];
  return dx * dx + dy * dy + dz * dz <= limit * limit;
}

template <class Real, FeatureStage Stage, Wanted kWanted>
void addFeatures(const FeatureRun& run, const Program& program, Block& b) {
  for (std::size_t k = 0; k < run.count; ++k) {
    const Feature& f = run.features[k];
    if (f.radius < program.minWavelength || !reaches(b, f.center, f.reach)) continue;
    const Shape<Real> shape = shapeOf<Real>(f, program);
    for (std::size_t chunk = 0; chunk * kChunk < b.count; ++chunk) {
      if (chunkReaches(b, chunk, f.center, f.reach))
        addFeatureToChunk<Real, Stage, kWanted>(f, shape, b, chunk * kChunk);
    }
  }
}

template <Wanted kWanted>
void addRun(const FeatureRun& run, const Program& program, Block& b) {
  switch (run.stage) {
    case FeatureStage::OldCrater:
      return run.inDouble ? addFeatures<double, FeatureStage::OldCrater, kWanted>(run, program, b)
                          : addFeatures<float, FeatureStage::OldCrater, kWanted>(run, program, b);
    case FeatureStage::YoungCrater:
      return run.inDouble ? addFeatures<double, FeatureStage::YoungCrater, kWanted>(run, program, b)
                          : addFeatures<float, FeatureStage::YoungCrater, kWanted>(run, program, b);
    case FeatureStage::Rock:
      return addFeatures<float, FeatureStage::Rock, kWanted>(run, program, b);
  }
}

/// Bright towards the crater, with five rays.
void addHaloToChunk(const Halo& h, float shown, Block& b, std::size_t begin) {
  const double cx = h.center[0], cy = h.center[1], cz = h.center[2];
  const float ax = static_cast<float>(h.axis1[0]), ay = static_cast<float>(h.axis1[1]),
              az = static_cast<float>(h.axis1[2]);
  const float bx = static_cast<float>(h.axis2[0]), by = static_cast<float>(h.axis2[1]),
              bz = static_cast<float>(h.axis2[2]);
  const float inverse = static_cast<float>(1.0 / h.radius), brightness = h.brightness * shown, rays = h.rays;
  constexpr float kInverseHaloSquared = static_cast<float>(1 / (kHaloRadii * kHaloRadii));
  for (std::size_t i = begin; i < begin + kChunk; ++i) {
    const float dx = static_cast<float>(b.x[i] - cx) * inverse, dy = static_cast<float>(b.y[i] - cy) * inverse,
                dz = static_cast<float>(b.z[i] - cz) * inverse;
    const float square = (dx * dx + dy * dy) + dz * dz;
    const float along = (dx * ax + dy * ay) + dz * az, across = (dx * bx + dy * by) + dz * bz;
    const float inverseRange = 1.0f / __builtin_sqrtf((along * along + across * across) + 1e-12f);
    const float c = along * inverseRange, s = across * inverseRange;
    const float c2 = c * c - s * s, s2 = 2.0f * c * s;
    const float c4 = c2 * c2 - s2 * s2, s4 = 2.0f * c2 * s2;
    const float c5 = c4 * c - s4 * s;
    const float rest = 1.0f - square * kInverseHaloSquared;
    const float halo = rest > 0.0f ? rest : 0.0f;
    b.bright[i] += brightness * (halo * halo) * (1.0f + rays * (c5 * (square / (square + 2.0f))));
  }
}

void addHalos(const Program& program, Block& b) {
  for (std::size_t k = 0; k < program.haloCount; ++k) {
    const Halo& h = program.halos[k];
    const double shown = shownShare(kHaloRadii * h.radius, program.minWavelength);
    if (shown <= 0 || !reaches(b, h.center, h.reach)) continue;
    for (std::size_t chunk = 0; chunk * kChunk < b.count; ++chunk) {
      if (chunkReaches(b, chunk, h.center, h.reach)) addHaloToChunk(h, static_cast<float>(shown), b, chunk * kChunk);
    }
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

}  // namespace

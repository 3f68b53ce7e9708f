// Craters, rocks and rays over one block of samples: part of every build of the lunar kernels.

#include "server/fields/lunar_profile.inl"
#include "server/fields/lunar_relief.inl"

namespace {

/// A boulder, steep sides and rounded top, or as much of one as a level shows: see rockSteepness.
template <class Real>
TERRANE_INLINE Profile<Real> rockProfile(const Shape<Real>& p, Real s) {
  const Real zero(0), rest = Real(1) - s * s, toRim = Real(1) - s;
  const Real q = rest > zero ? rest : zero, d = toRim > zero ? toRim : zero;
  const Real dome = d * d, domeSlope = Real(-2) * d, steepSlope = Real(-4) * s * q;
  return {p.peak * (dome + p.steepness * (q * q - dome)) * p.shown,
          p.peak * (domeSlope + p.steepness * (steepSlope - domeSlope)) * p.keptSlope};
}

/// The samples of a block's chunks that a feature reaches, in its own frame. Worked on in several passes: one loop over
/// all of it would be a chain of a hundred operations, of which a processor overlaps few.
template <class Real>
struct Reached {
  std::size_t count = 0, chunkCount = 0;
  std::size_t ejectaBegin = 0;       ///< the samples from here on see a crater's apron alone
  std::size_t begins[kBlockChunks];  ///< of the chunks in the block
  alignas(64) Real dx[kBlockCapacity], dy[kBlockCapacity], dz[kBlockCapacity];  ///< from the centre, metres
  alignas(64) Real square[kBlockCapacity];                                      ///< of the distance, in radii
  alignas(64) Real cosine[kBlockCapacity], sine[kBlockCapacity];                ///< of the bearing
  alignas(64) Real inverseRange[kBlockCapacity];                                ///< of the distance in the ground plane
  alignas(64) Real outline[kBlockCapacity], turn[kBlockCapacity];               ///< and its derivative by the bearing
  alignas(64) Real value[kBlockCapacity], slope[kBlockCapacity];                ///< of the profile
};

template <class Real>
void placeSamples(const Feature& f, const Block& b, Reached<Real>& at) {
  const double cx = f.center[0], cy = f.center[1], cz = f.center[2];
  for (std::size_t k = 0; k < at.chunkCount; ++k) {
    const std::size_t from = at.begins[k], to = k * kChunk;
#pragma GCC unroll 1  // or the compiler makes vectors of the outer loop
    for (std::size_t i = 0; i < kChunk; ++i) {
      at.dx[to + i] = static_cast<Real>(b.x[from + i] - cx);
      at.dy[to + i] = static_cast<Real>(b.y[from + i] - cy);
      at.dz[to + i] = static_cast<Real>(b.z[from + i] - cz);
    }
  }
  const Real ax = Real(f.axis1[0]), ay = Real(f.axis1[1]), az = Real(f.axis1[2]);
  const Real bx = Real(f.axis2[0]), by = Real(f.axis2[1]), bz = Real(f.axis2[2]);
  const Real inverse = Real(1.0 / f.radius), inverseSquared = inverse * inverse;
  for (std::size_t i = 0; i < at.count; ++i) {
    const Real dx = at.dx[i], dy = at.dy[i], dz = at.dz[i];
    at.square[i] = (dx * dx + dy * dy + dz * dz) * inverseSquared;
    const Real along = (dx * ax + dy * ay + dz * az) * inverse, across = (dx * bx + dy * by + dz * bz) * inverse;
    const Real inverseRange = Real(1) / squareRoot<Real>(along * along + across * across + Real(1e-12));
    at.cosine[i] = along * inverseRange;
    at.sine[i] = across * inverseRange;
    at.inverseRange[i] = inverseRange;
  }
}

/// An outline, 1 + the sum of cos and sin of 2..5 times the bearing, as A(c) + s B(c) of the bearing's cosine and sine:
/// with Chebyshev's polynomials, cos(k b) = T_k(c) and sin(k b) = s U_(k-1)(c).
template <class Real>
struct OutlinePolynomials {
  Real a[6], b[5];
  TERRANE_INLINE explicit OutlinePolynomials(const Feature& f) {
    const double *c = f.lobeCos, *s = f.lobeSin;
    a[0] = Real(1 - c[0] + c[2]);
    a[1] = Real(5 * c[3] - 3 * c[1]);
    a[2] = Real(2 * c[0] - 8 * c[2]);
    a[3] = Real(4 * c[1] - 20 * c[3]);
    a[4] = Real(8 * c[2]);
    a[5] = Real(16 * c[3]);
    b[0] = Real(s[3] - s[1]);
    b[1] = Real(2 * s[0] - 4 * s[2]);
    b[2] = Real(4 * s[1] - 12 * s[3]);
    b[3] = Real(8 * s[2]);
    b[4] = Real(16 * s[3]);
  }
};

/// And, if wanted, its derivative by the bearing: c B - s (A' + s B').
template <class Real, Wanted kWanted>
void outlineSamples(const Feature& f, Reached<Real>& at) {
  static_assert(kLobes == 4);
  const OutlinePolynomials<Real> p(f);
  const Real a0 = p.a[0], a1 = p.a[1], a2 = p.a[2], a3 = p.a[3], a4 = p.a[4], a5 = p.a[5];
  const Real b0 = p.b[0], b1 = p.b[1], b2 = p.b[2], b3 = p.b[3], b4 = p.b[4];
  const Real slopeA1 = Real(2) * a2, slopeA2 = Real(3) * a3, slopeA3 = Real(4) * a4, slopeA4 = Real(5) * a5;
  const Real slopeB1 = Real(2) * b2, slopeB2 = Real(3) * b3, slopeB3 = Real(4) * b4;
  for (std::size_t i = 0; i < at.count; ++i) {
    const Real c = at.cosine[i], s = at.sine[i];
    const Real a = a0 + c * (a1 + c * (a2 + c * (a3 + c * (a4 + c * a5))));
    const Real b = b0 + c * (b1 + c * (b2 + c * (b3 + c * b4)));
    at.outline[i] = a + s * b;
    if constexpr (kWanted == Wanted::Heights) continue;
    const Real slopeA = a1 + c * (slopeA1 + c * (slopeA2 + c * (slopeA3 + c * slopeA4)));
    const Real slopeB = b1 + c * (slopeB1 + c * (slopeB2 + c * slopeB3));
    at.turn[i] = c * b - s * (slopeA + s * slopeB);
  }
}

template <class Real, bool kRock, Wanted kWanted>
void profileSamples(const Shape<Real>& shape, Reached<Real>& at) {
  for (std::size_t i = 0; i < at.ejectaBegin; ++i) {
    const Real stretched = at.square[i] * at.outline[i] * at.outline[i];
    const Profile<Real> h = kRock ? rockProfile<Real>(shape, stretched) : craterProfile<Real>(shape, stretched);
    at.value[i] = h.value;
    if constexpr (kWanted == Wanted::All) at.slope[i] = h.slope;
  }
  for (std::size_t i = at.ejectaBegin; i < at.count; ++i) {
    const Profile<Real> h = ejectaProfile<Real>(shape, at.square[i] * at.outline[i] * at.outline[i]);
    at.value[i] = h.value;
    if constexpr (kWanted == Wanted::All) at.slope[i] = h.slope;
  }
}

/// The stage is a compile-time choice so that the compiler sees which arrays of the block are written, and vectorises.
template <class Real, FeatureStage Stage, Wanted kWanted>
void addReached(const Feature& f, float brightness, const Reached<Real>& at, Block& b) {
  constexpr bool kRock = Stage == FeatureStage::Rock, kOld = Stage == FeatureStage::OldCrater;
  const Real ax = Real(f.axis1[0]), ay = Real(f.axis1[1]), az = Real(f.axis1[2]);
  const Real bx = Real(f.axis2[0]), by = Real(f.axis2[1]), bz = Real(f.axis2[2]);
  const Real inverse = Real(1.0 / f.radius), inverseSquared = inverse * inverse;
  for (std::size_t k = 0; k < at.chunkCount; ++k) {
    const std::size_t to = at.begins[k], from = k * kChunk;
#pragma GCC unroll 1
    for (std::size_t j = 0; j < kChunk; ++j) {
      const std::size_t i = to + j, n = from + j;
      (kOld ? b.relief : b.young)[i] += static_cast<double>(at.value[n]);
      if constexpr (kWanted == Wanted::Heights) continue;
      const Real outline = at.outline[n], twice = at.slope[n] * Real(2), c = at.cosine[n], s = at.sine[n];
      const Real radial = twice * outline * outline * inverseSquared;
      const Real angular = twice * at.square[n] * outline * at.turn[n] * at.inverseRange[n] * inverse;
      (kOld ? b.reliefX : b.youngX)[i] += static_cast<float>(radial * at.dx[n] + angular * (c * bx - s * ax));
      (kOld ? b.reliefY : b.youngY)[i] += static_cast<float>(radial * at.dy[n] + angular * (c * by - s * ay));
      (kOld ? b.reliefZ : b.youngZ)[i] += static_cast<float>(radial * at.dz[n] + angular * (c * bz - s * az));
      if constexpr (kRock) {
        const float rest = 1.0f - static_cast<float>(at.square[n]);
        const float inside = rest > 0.0f ? rest : 0.0f;
        b.bright[i] += brightness * (inside * inside);
      }
    }
  }
}

/// Which of a block's chunks what ends so far from a feature's or halo's middle touches: bits by chunk.
TERRANE_INLINE std::uint32_t chunksWithin(const Block& b, const double* center, double reach) {
  typedef std::int64_t Bits __attribute__((vector_size(32)));
  const Lanes *x = reinterpret_cast<const Lanes*>(b.chunkX), *y = reinterpret_cast<const Lanes*>(b.chunkY),
              *z = reinterpret_cast<const Lanes*>(b.chunkZ), *radius = reinterpret_cast<const Lanes*>(b.chunkRadius);
  Bits bit = {1, 2, 4, 8}, bits = {};
  for (std::size_t k = 0; k < kChunkSlots / 4; ++k, bit <<= 4) {
    const Lanes dx = x[k] - center[0], dy = y[k] - center[1], dz = z[k] - center[2], limit = reach + radius[k];
    bits |= (dx * dx + dy * dy + dz * dz <= limit * limit) & bit;
  }
  const auto all = static_cast<std::uint32_t>((bits[0] | bits[1]) | (bits[2] | bits[3]));
  return all & ((1u << (b.count / kChunk)) - 1u);
}

template <class Real>
TERRANE_INLINE void listChunks(std::uint32_t chunks, Reached<Real>& at) {
  for (; chunks != 0; chunks &= chunks - 1)
    at.begins[at.chunkCount++] = static_cast<std::size_t>(__builtin_ctz(chunks)) * kChunk;
}

/// Those of chunks last that lie beyond innerReach from a feature's middle.
template <class Real>
void findChunks(std::uint32_t chunks, const Feature& f, double innerReach, const Block& b, Reached<Real>& at) {
  const std::uint32_t inner = innerReach < f.reach ? chunks & chunksWithin(b, f.center, innerReach) : chunks;
  at.chunkCount = 0;
  listChunks(inner, at);
  at.ejectaBegin = at.chunkCount * kChunk;
  listChunks(chunks & ~inner, at);
  at.count = at.chunkCount * kChunk;
}

template <class Real, FeatureStage Stage, Wanted kWanted>
void addFeatures(const FeatureRun& run, const Program& program, Block& b) {
  constexpr bool kRock = Stage == FeatureStage::Rock;
  Reached<Real> at;
  for (std::size_t k = 0; k < run.count; ++k) {
    const Feature& f = run.features[k];
    if (f.radius < program.minWavelength || !reaches(b, f.center, f.reach)) continue;
    const std::uint32_t chunks = chunksWithin(b, f.center, f.reach);
    if (chunks == 0) continue;
    const Shape<Real> shape = shapeOf<Real>(f, program);
    // The reach is where the apron ends on the outline's narrowest bearing.
    const double share = kRock ? 1.0 : ejectaFrom<Real>(shape) * (1.0 / kApronRadii);
    findChunks(chunks, f, share * f.reach, b, at);
    placeSamples(f, b, at);
    outlineSamples<Real, kWanted>(f, at);
    profileSamples<Real, kRock, kWanted>(shape, at);
    addReached<Real, Stage, kWanted>(f, f.brightness * static_cast<float>(shape.shown), at, b);
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

void addHalos(const HaloRun& run, const Program& program, Block& b) {
  for (std::size_t k = 0; k < run.count; ++k) {
    const Halo& h = run.halos[k];
    if (!reaches(b, h.center, h.reach)) continue;
    const double shown = shownShare(kHaloRadii * h.radius, program.minWavelength);
    if (shown <= 0) continue;
    for (std::uint32_t chunks = chunksWithin(b, h.center, h.reach); chunks != 0; chunks &= chunks - 1)
      addHaloToChunk(h, static_cast<float>(shown), b, static_cast<std::size_t>(__builtin_ctz(chunks)) * kChunk);
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

// The lunar height field over one block of samples: part of every build of the lunar kernels. See lunar_field.h for the
// model. Included after lunar_program.h and with kEvaluate naming the entry.

#include "server/fields/lunar_far.inl"

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

void clearBlock(Block& b) {
  for (std::size_t i = 0; i < b.count; ++i) {
    b.relief[i] = b.lava[i] = b.young[i] = 0.0;
    b.dry[i] = 1.0;
    b.reliefX[i] = b.reliefY[i] = b.reliefZ[i] = b.lavaX[i] = b.lavaY[i] = b.lavaZ[i] = 0.0f;
    b.dryX[i] = b.dryY[i] = b.dryZ[i] = b.youngX[i] = b.youngY[i] = b.youngZ[i] = 0.0f;
    b.rough[i] = b.last[i] = 0.0;
    b.roughX[i] = b.roughY[i] = b.roughZ[i] = b.lastX[i] = b.lastY[i] = b.lastZ[i] = b.bright[i] = b.mottle[i] = 0.0f;
  }
}

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

/// A sample's slope along the ground, and its reflectance: its ground's, brighter where slopes or youth expose fresh
/// material.
TERRANE_INLINE void finishSample(float gx, float gy, float gz, float ground, double inverseRadius, std::size_t i,
                                 Block& b) {
  const float nx = static_cast<float>(b.x[i] * inverseRadius), ny = static_cast<float>(b.y[i] * inverseRadius),
              nz = static_cast<float>(b.z[i] * inverseRadius);
  const float outward = (gx * nx + gy * ny) + gz * nz;
  gx -= outward * nx;
  gy -= outward * ny;
  gz -= outward * nz;
  b.gradientX[i] = gx;
  b.gradientY[i] = gy;
  b.gradientZ[i] = gz;
  const float squareSlope = (gx * gx + gy * gy) + gz * gz;
  const float steep = squareSlope / (squareSlope + 0.5f);
  const float mottling = 1.0f + 0.10f * b.mottle[i] + 0.35f * steep;
  const float tint = ground * mottling + b.bright[i];
  b.reflectance[i] = tint < 0.03f ? 0.03f : tint > 0.38f ? 0.38f : tint;
}

/// Floods the relief, adds what is young, clamps (C2, so that no sum of overlapping features leaves the stated range),
/// roughens.
template <Wanted kWanted>
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
    const float dry = static_cast<float>(b.dry[i]);
    const float calm = 1.0f - smoothing * (1.0f - dry), roughCalm = smoothing * static_cast<float>(b.rough[i]);
    b.height[i] = static_cast<double>(calm) * b.rough[i] - top.value;
    if constexpr (kWanted == Wanted::Heights) continue;

    const float keep = static_cast<float>(bottom.weight * top.weight);
    const float lavaX = b.lavaX[i] - lavaRise * b.dryX[i], lavaY = b.lavaY[i] - lavaRise * b.dryY[i],
                lavaZ = b.lavaZ[i] - lavaRise * b.dryZ[i];
    const float land = landShare(static_cast<float>(b.relief[i] - lava), b.reliefX[i] - lavaX, b.reliefY[i] - lavaY,
                                 b.reliefZ[i] - lavaZ, lavaBlend, footprint);
    const float mare = keep * (1.0f - land), landKeep = land * keep;

    float gx = landKeep * b.reliefX[i] + mare * lavaX + keep * b.youngX[i];
    float gy = landKeep * b.reliefY[i] + mare * lavaY + keep * b.youngY[i];
    float gz = landKeep * b.reliefZ[i] + mare * lavaZ + keep * b.youngZ[i];
    gx += calm * b.roughX[i] + roughCalm * b.dryX[i];
    gy += calm * b.roughY[i] + roughCalm * b.dryY[i];
    gz += calm * b.roughZ[i] + roughCalm * b.dryZ[i];
    const float highland = kHighlandTint + kHeightTint * static_cast<float>(b.relief[i] * p.inverseReliefAmplitude),
                basalt = kBasaltTint + 0.004f * static_cast<float>(b.lava[i]) * lavaTint;
    finishSample(gx, gy, gz, basalt + land * (highland - basalt), inverseRadius, i, b);
  }
}

/// The same over an expansion of ground that is not mixed: a sum.
template <Wanted kWanted>
void composePlainHeight(const Program& p, Block& b) {
  const double calm = p.far->calm, inverseRadius = 1.0 / p.radius;
  const float singleCalm = static_cast<float>(calm), tint = p.far->tint, tintPerMeter = p.far->tintPerMeter;
  for (std::size_t i = 0; i < b.count; ++i) {
    b.height[i] = calm * b.rough[i] + (b.relief[i] + b.young[i]);
    if constexpr (kWanted == Wanted::Heights) continue;
    finishSample(b.reliefX[i] + b.youngX[i] + singleCalm * b.roughX[i],
                 b.reliefY[i] + b.youngY[i] + singleCalm * b.roughY[i],
                 b.reliefZ[i] + b.youngZ[i] + singleCalm * b.roughZ[i],
                 tint + tintPerMeter * static_cast<float>(b.relief[i]), inverseRadius, i, b);
  }
}

constexpr double kBoundSlack = 1 + 1e-9;  ///< for roundings

/// Around each chunk, about the middle between its first and last sample, and around them all.
void boundBlock(Block& b) {
  double low[3], high[3];
  for (std::size_t chunk = 0; chunk * kChunk < b.count; ++chunk) {
    const std::size_t first = chunk * kChunk, last = first + kChunk - 1;
    const double center[3] = {0.5 * (b.x[first] + b.x[last]), 0.5 * (b.y[first] + b.y[last]),
                              0.5 * (b.z[first] + b.z[last])};
    alignas(64) double squares[kChunk];
#pragma GCC unroll 1
    for (std::size_t i = 0; i < kChunk; ++i) {
      const double dx = b.x[first + i] - center[0], dy = b.y[first + i] - center[1], dz = b.z[first + i] - center[2];
      squares[i] = (dx * dx + dy * dy) + dz * dz;
    }
    b.chunkX[chunk] = center[0];
    b.chunkY[chunk] = center[1];
    b.chunkZ[chunk] = center[2];
    double nearest, farthest;
    findExtent(squares, kChunk, nearest, farthest);
    b.chunkRadius[chunk] = __builtin_sqrt(farthest) * kBoundSlack;
    for (int a = 0; a < 3; ++a) {
      low[a] = chunk == 0 || center[a] < low[a] ? center[a] : low[a];
      high[a] = chunk == 0 || center[a] > high[a] ? center[a] : high[a];
    }
  }
  for (int a = 0; a < 3; ++a) b.center[a] = 0.5 * (low[a] + high[a]);
  b.radius = 0;
  for (std::size_t chunk = 0; chunk * kChunk < b.count; ++chunk) {
    const double dx = b.chunkX[chunk] - b.center[0], dy = b.chunkY[chunk] - b.center[1],
                 dz = b.chunkZ[chunk] - b.center[2];
    const double radius = __builtin_sqrt(dx * dx + dy * dy + dz * dz) * kBoundSlack + b.chunkRadius[chunk];
    b.radius = radius > b.radius ? radius : b.radius;
  }
}

template <Wanted kWanted>
void evaluateAll(const Program& program, Block& block) {
  boundBlock(block);
  if (program.far != nullptr) {
    startFromFar<kWanted>(*program.far, block);
  } else {
    clearBlock(block);
  }
  addRelief<kWanted>(program, block);
  for (std::size_t k = 0; k < program.basinCount; ++k) {
    if (reaches(block, program.basins[k].center, program.basins[k].reach)) addBasin<kWanted>(program.basins[k], block);
  }
  for (std::size_t k = 0; k < program.patchCount; ++k) {
    if (reaches(block, program.patches[k].center, program.patches[k].reach))
      addPatch<kWanted>(program.patches[k], block);
  }
  for (std::size_t k = 0; k < program.regolithCount; ++k) addRegolith<kWanted>(program.regolith[k], program, block);
  for (std::size_t k = 0; k < program.runCount; ++k) addRun<kWanted>(program.runs[k], program, block);
  if constexpr (kWanted == Wanted::All) {
    for (std::size_t k = 0; k < program.haloRunCount; ++k) addHalos(program.halos[k], program, block);
    for (std::size_t k = 0; k < program.rayCount; ++k) {
      if (reaches(block, program.rays[k].center, program.rays[k].reach)) addRays(program.rays[k], block);
    }
  }
  if (isPlain(program)) {
    composePlainHeight<kWanted>(program, block);
  } else {
    composeHeight<kWanted>(program, block);
  }
}

}  // namespace

void kEvaluate(const Program& program, Block& block) noexcept {
  if (program.heightsOnly) {
    evaluateAll<Wanted::Heights>(program, block);
  } else {
    evaluateAll<Wanted::All>(program, block);
  }
}

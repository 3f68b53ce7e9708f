#pragma once
// What the lunar kernels run: plain tables (noise octaves, landmarks, craters and rocks) and the block of samples that
// they work on. Plain data only, so that the vector builds of the kernels emit no inline function that the linker could
// pick for code that must run on older CPUs. Body frame, metres. Tables are read-only during a run; a block belongs to
// one thread.

#include <cstddef>
#include <cstdint>

#include "common/numerics/strict_math.h"

/// The vector builds of the kernels emit no function that other code could be linked to.
#define TERRANE_INLINE inline __attribute__((always_inline))

namespace terrane::lunar {

/// A level computes in float32, relative to their cell or centre, octaves of shorter wavelengths and features of
/// smaller radii than so many times its own shortest wavelength, and the rest in double, or fine levels would show
/// steps. The roundings of all that is in float32, some thirty of 2^-24 each, stay below singleRounding: the amplitudes
/// of such octaves sum to some 40 wavelengths of the level, those of such craters to some 1,000, were all to meet in
/// one place. No more than 0.1 m at any level: no level's amplitudes sum to more than 45 km.
inline constexpr double kDoubleWavelengths = 512, kDoubleRadii = 256;
TERRANE_INLINE double singleRounding(double minWavelength) noexcept {
  const double bound = 2e-3 * minWavelength;
  return bound < 0.1 ? bound : 0.1;
}

/// Samples are worked on in compact blocks, in chunks of one AVX-512 vector.
inline constexpr std::size_t kChunk = 16;
inline constexpr std::size_t kBlockCapacity = 256;
inline constexpr std::size_t kBlockChunks = kBlockCapacity / kChunk;
inline constexpr std::size_t kChunkSlots = (kBlockChunks + 3) / 4 * 4;  ///< in whole vectors

/// One octave of gradient noise. cell coordinate = (rotation * position) / wavelength + offset.
struct NoiseOctave {
  double inverseWavelength;  ///< a power of two: the product is exact
  double offset[3];          ///< moves the lattice, so that the zeros of two octaves never meet
  double amplitude;          ///< metres, of relief or regolith
  double lavaAmplitude;      ///< metres, of the lava's surface (relief group only)
  double mottle;             ///< share in the mottling of the ground's brightness
  std::uint32_t seed;
};

/// Whether a group is all of its octaves, or those that the far field holds (far_field.h), or the others.
enum class GroupPart : std::uint8_t { Whole, Far, Near };

/// Octaves that share a rotation and are summed before they are turned back.
struct NoiseGroup {
  const NoiseOctave* octaves;
  std::size_t count;
  double rotation[9];  ///< row-major; orthogonal
  double modulation;   ///< group is scaled by 1 + modulation * (last octave of the group before, -1.04..1.04)
  GroupPart part = GroupPart::Whole;  ///< of a regolith group
};

/// A basin: a bowl (1 - u^2)^3 with a ring of mountains around u = 1, u = distance^2 / radius^2.
struct Basin {
  double center[3];
  double inverseRadiusSquared;
  double reach;  ///< metres: no influence beyond
  double depth, ring;
};

inline constexpr double kBasinRingHalfWidth = 0.45;  ///< in u

/// Where lava may stand: 1 within the inner radius, 0 beyond reach, in u = distance^2 / reach^2.
struct LavaPatch {
  double center[3];
  double inverseReachSquared;
  double reach;
  double innerSquared;  ///< u up to which the patch is 1
  double inverseRamp;   ///< 1 / (1 - innerSquared)
};

/// Rays of a young crater: reflectance only.
struct RaySystem {
  double center[3];
  double axis1[3], axis2[3];
  double inverseRadius, reach;
  float inverseReachInRadii, strength;
  float phase[6];  ///< cos, sin of three phases
};

inline constexpr int kLobes = 4;  // angular orders 2..5

/// One crater or rock.
struct Feature {
  double center[3];
  double axis1[3], axis2[3];  ///< tangent frame
  double radius;
  double reach;              ///< metres (chord); nothing beyond
  double apex, rise;         ///< bowl = apex + rise * s, s = (distance / radius)^2
  double floor, floorBlend;  ///< flat floor
  double rim, rimBlend;      ///< rim height; roundness of the crest
  double peak;               ///< central peak (crater), height (rock)
  double lobeCos[kLobes], lobeSin[kLobes];
  float brightness;  ///< of a rock, over its surroundings
};

/// Bright ground around a young crater, with rays: reflectance only.
struct Halo {
  double center[3];
  double axis1[3], axis2[3];  ///< the crater's tangent frame
  double radius, reach;       ///< of the crater; metres (chord) beyond which there is nothing
  float brightness, rays;
};

inline constexpr double kApronRadii = 2.2;          ///< ejecta end here, in crater radii
inline constexpr double kHaloRadii = 4.5;           ///< halos of young craters end here
inline constexpr double kPeakRadiusSquared = 0.06;  ///< central peak, in crater radii squared

/// How much of a feature of this radius a level shows whose shortest wavelength is minWavelength: nothing up to that
/// radius, all of it from four times that on, so that what is new at a level is small beside what was there.
TERRANE_INLINE double shownShare(double radius, double minWavelength) noexcept {
  const double u = minWavelength / radius;
  const double s = u >= 1.0 ? 0.0 : u <= 0.25 ? 1.0 : (1.0 - u) * (1.0 / 0.75);
  return 0.5 * s * (1.0 + s);
}

/// What is left of a wave's slope when it is averaged over +-footprint: sin(pi u) / (pi u) with u = 2 footprint /
/// wavelength, by the first factors of its product.
TERRANE_INLINE double keptSlope(double footprint, double inverseWavelength) noexcept {
  const double u = 2.0 * footprint * inverseWavelength, square = u * u;
  return square < 1.0 ? (1.0 - square) * (1.0 - 0.25 * square) : 0.0;
}

enum class FeatureStage : std::uint8_t { OldCrater, YoungCrater, Rock };

/// A rock is (1 - s^2)^2 of its height at s = (distance / radius)^2, with a flank a quarter of its radius wide. A level
/// too coarse for the flank shows the dome (1 - s)^2 instead, or the light would break into teeth along the foot: 0
/// (dome, up to a radius of twice minWavelength) .. 1 (rock, from eight times on). Between the two lies at most
/// kDomeGap of the height: s (2 + s) (1 - s)^2 is 0.3481 at 0.366.
TERRANE_INLINE double rockSteepness(double radius, double minWavelength) noexcept {
  return shownShare(0.5 * radius, minWavelength);
}
inline constexpr double kDomeGap = 0.35;

/// Features of one layer, in canonical order.
struct FeatureRun {
  const Feature* features;
  std::size_t count;
  FeatureStage stage;
  bool inDouble;
};

/// Halos, in canonical order.
struct HaloRun {
  const Halo* halos;
  std::size_t count;
};

struct FarExpansion;

struct Program {
  const FarExpansion* far;  ///< what the rest is added to; null for nothing
  bool heightsOnly;         ///< a block's gradients and reflectance are left as they are
  double radius;
  double minWavelength;  ///< metres: features and halos of smaller radii are left out, of somewhat larger ones shown in
                         ///< part
  double footprint;      ///< metres: gradients and reflectance are averaged over this far; 0 for none
  double doubleWavelength;  ///< metres: octaves from here on are computed in double
  NoiseGroup relief;        ///< two sums: relief and lava
  const NoiseGroup* regolith;
  std::size_t regolithCount;
  const Basin* basins;
  std::size_t basinCount;
  const LavaPatch* patches;
  std::size_t patchCount;
  const RaySystem* rays;
  std::size_t rayCount;
  const FeatureRun* runs;
  std::size_t runCount;
  const HaloRun* halos;
  std::size_t haloRunCount;
  double lavaTop, lavaFloor, lavaBlend;
  double clampLow, clampHigh, clampBlend;
  double mareSmoothing;  ///< regolith in full mare is scaled by 1 - this
  double inverseReliefAmplitude;
};

/// Reflectance of level ground before it is mottled, of highlands at relief 0 and of lava at its mean level, and what
/// the relief's amplitude adds to it.
inline constexpr float kHighlandTint = 0.138f, kBasaltTint = 0.055f, kHeightTint = 0.012f;

/// All of a block's working memory and its results.
struct alignas(64) Block {
  std::size_t count;                                                                 ///< padded to whole chunks
  alignas(64) double chunkX[kChunkSlots], chunkY[kChunkSlots], chunkZ[kChunkSlots];  ///< balls around the chunks
  double chunkRadius[kChunkSlots];
  double center[3], radius;

  alignas(64) double x[kBlockCapacity], y[kBlockCapacity], z[kBlockCapacity];
  alignas(64) double rotatedX[kBlockCapacity], rotatedY[kBlockCapacity], rotatedZ[kBlockCapacity];
  alignas(64) double relief[kBlockCapacity], lava[kBlockCapacity], dry[kBlockCapacity];
  alignas(64) float reliefX[kBlockCapacity], reliefY[kBlockCapacity], reliefZ[kBlockCapacity];
  alignas(64) float lavaX[kBlockCapacity], lavaY[kBlockCapacity], lavaZ[kBlockCapacity];
  alignas(64) float dryX[kBlockCapacity], dryY[kBlockCapacity], dryZ[kBlockCapacity];
  alignas(64) double young[kBlockCapacity];
  alignas(64) float youngX[kBlockCapacity], youngY[kBlockCapacity], youngZ[kBlockCapacity];
  alignas(64) double rough[kBlockCapacity];
  alignas(64) float roughX[kBlockCapacity], roughY[kBlockCapacity], roughZ[kBlockCapacity];
  alignas(64) float bright[kBlockCapacity], mottle[kBlockCapacity];
  /// The last octave of the group done last, which scales the next.
  alignas(64) double last[kBlockCapacity];
  alignas(64) float lastX[kBlockCapacity], lastY[kBlockCapacity], lastZ[kBlockCapacity];
  /// The octaves of a regolith group, added up; before a group that is near in part, of its far part.
  alignas(64) double sum[kBlockCapacity];
  alignas(64) float sumX[kBlockCapacity], sumY[kBlockCapacity], sumZ[kBlockCapacity];

  alignas(64) double height[kBlockCapacity];
  alignas(64) float gradientX[kBlockCapacity], gradientY[kBlockCapacity], gradientZ[kBlockCapacity];
  alignas(64) float reflectance[kBlockCapacity];
};

using EvaluateBlock = void (*)(const Program&, Block&) noexcept;

void evaluateBlockDefault(const Program& program, Block& block) noexcept;
void evaluateBlockV3(const Program& program, Block& block) noexcept;
void evaluateBlockV4(const Program& program, Block& block) noexcept;

}  // namespace terrane::lunar

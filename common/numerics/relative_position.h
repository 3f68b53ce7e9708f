#pragma once
// A vertex relative to the camera, in float, from positions that float cannot hold: what the CPU prepares for each
// scheme, and the CPU's form of what the shader then does (relative_position.glsl, one source for both). Body frame,
// metres. Pure functions, thread-safe.
//
//   scheme             a vertex is                    error of a component of the result, u = 2^-24
//   lattice integers   steps from its tile's origin   2.5 u of itself, +- u step: exact but for the camera's rest, and
//                                                     rounded in the subtraction; beyond 2^24 steps the conversion too
//   morphed integers   steps, and a share of those   3.5 u of itself and of the way to the parent's mesh, +- u step
//                      to the parent's mesh
//   camera-relative    float(position - camera), by   u of itself, +- 2^-53 of the distance from the origin; costs the
//                      the CPU, every frame           CPU and the bus 12 bytes a vertex and frame
//   double-float       two floats (double_float3.h)   u of itself, +- 2 u^2 of the distance from the origin
//   65536 m and rest   two floats, added word by      u of itself, +- 2^-8 m: half an ulp below 65536 m for each of the
//                      word                           two; to 2^40 m, where multiples of 65536 m end (Cesium)
//   tile and offset    tiled_position.h               +- u S / 2 for what is near (relativeByHalves): half an ulp below
//                                                     S/2 for each of the two; twice that by tiles and offsets

#include <cstdint>
#include <glm/ext/vector_int3_sized.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "common/numerics/strict_math.h"

namespace terrane {

namespace relative_position_bare {

using glm::ivec3;
using glm::vec3;

#define PRECISE
#define FUNCTION inline
#include "common/numerics/relative_position.glsl"
#undef PRECISE
#undef FUNCTION

}  // namespace relative_position_bare

using relative_position_bare::relativeByHalves;
using relative_position_bare::relativeByTilesAndOffsets;
using relative_position_bare::relativeMorphed;
using relative_position_bare::relativeOnLattice;

/// The subtraction in double, rounded once.
inline glm::vec3 cameraRelative(const glm::dvec3& positionBody, const glm::dvec3& cameraBody) noexcept {
  return glm::vec3(positionBody - cameraBody);
}

/// The camera on a level's lattice: rounded down to a lattice point, and the rest in steps, 0..1 (1 when float rounds
/// up to it).
struct CameraOnLattice {
  glm::i64vec3 steps{0};
  glm::vec3 rest{0.0f};
};
/// stepMeters: a power of two. Beyond +-2^62 steps, or where it is NaN: clamped, or 0.
CameraOnLattice cameraOnLattice(const glm::dvec3& cameraBody, double stepMeters) noexcept;

/// How many steps a camera on a lattice lies above the same camera on a lattice of twice the step: 0 or 1 an axis.
inline glm::ivec3 cameraOdd(const CameraOnLattice& camera, const CameraOnLattice& onParents) noexcept {
  return glm::ivec3(camera.steps - onParents.steps * std::int64_t{2});
}

/// origin - camera in steps as the shader's 32-bit integers; empty when a component is beyond +-kMaxPlacedSteps. A
/// selection made for the camera never comes near (it draws no tile from 30,000 tile widths away); a frozen selection
/// that the viewer flies away from can. Such a tile is then placed on the CPU.
std::optional<glm::ivec3> originMinusCamera(const glm::i64vec3& origin, const glm::i64vec3& cameraSteps) noexcept;
inline constexpr std::int64_t kMaxPlacedSteps = std::int64_t{1} << 30;

}  // namespace terrane

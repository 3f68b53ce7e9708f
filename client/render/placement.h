#pragma once
// What the CPU computes for a placement: a tile's origin and the camera, in the form that the vertex shader takes. Body
// frame; pure functions, thread-safe.

#include <glm/vec3.hpp>
#include <optional>

#include "common/tiling/lattice.h"

namespace terrane {

/// The camera on a level's lattice: rounded down to a lattice point, and the rest in steps, 0..1 (1 when float rounds
/// up to it).
struct CameraOnLattice {
  LatticePoint steps{0};
  glm::vec3 rest{0.0f};
};
CameraOnLattice cameraOnLattice(const glm::dvec3& cameraBody, int stepExponent) noexcept;

/// origin - camera in steps as the shader's 32-bit integers; empty when a component is beyond +-kMaxPlacedSteps. A
/// selection made for the camera never comes near (it draws no tile from 30,000 tile widths away); a frozen selection
/// that the viewer flies away from can. Such a tile is then placed on the CPU.
std::optional<glm::ivec3> originMinusCamera(const LatticePoint& origin, const LatticePoint& cameraSteps) noexcept;
inline constexpr std::int64_t kMaxPlacedSteps = std::int64_t{1} << 30;

/// A double as high + low floats, exact to 48 bits.
struct FloatPairVec {
  glm::vec3 high{0.0f}, low{0.0f};
};
FloatPairVec splitToFloats(const glm::dvec3& value) noexcept;

}  // namespace terrane

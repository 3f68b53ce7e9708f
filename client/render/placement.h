#pragma once
// The ways in which a vertex finds its place relative to the camera. The arithmetic is
// common/numerics/relative_position.h's and double_float3.h's. Thread-safe.

#include <cstdint>
#include <string_view>

#include "common/result.h"

namespace terrane {

enum class Placement : std::uint8_t {
  Integer,      ///< (origin - camera) in steps + offset, as integers in the shader; converted once, then minus the
                ///< camera's sub-step rest
  DoubleFloat,  ///< origin + offset * step as a double-float, minus the camera as a double-float, in the shader
  Cpu,          ///< double on the CPU, uploaded as camera-relative floats every frame (the reference)
  Float32,      ///< origin + offset * step as plain floats: the control that jitters
};
std::string_view placementName(Placement placement) noexcept;
/// Errors name "--placement" and list what is allowed.
Result<Placement> parsePlacement(std::string_view text);

}  // namespace terrane

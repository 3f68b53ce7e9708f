#pragma once
// Draws what the ground looks like below its mesh, as a factor on the picture: noise in octaves of power-of-two
// wavelengths, chosen pixel by pixel so that the finest is a few pixels long (client/shaders/detail.frag.glsl). It asks
// the picture's depth for the ground's place, not the tiles, so that it costs the same whatever the triangles, knows no
// tile borders and no levels, and lies still: a texel is where it is in the body, to within 2^-22 of its distance from
// the camera plus 2^-23 of its wavelength (common/numerics/octave_coordinates.h). GL thread only.

#include <array>
#include <memory>

#include "client/gl/shader_program.h"
#include "client/render/effect_pass.h"

namespace terrane {

/// Wavelengths 2^-13 m (0.12 mm) to 2^18 m (262 km).
inline constexpr int kFinestDetailExponent = -13, kDetailOctaves = 32;

struct DetailStrength {
  // By octave, finest first.
  std::array<float, kDetailOctaves> slopes{};   ///< of the relief
  std::array<float, kDetailOctaves> mottles{};  ///< of the reflectance, a share
  /// The shortest wavelength that is shown, fading in up to twice that. Below two pixels it would shimmer.
  float finestPixels = 2.5f;
};

/// Errors: Unsupported ("shader").
Result<std::unique_ptr<EffectPass>> makeDetailPass(const DetailStrength& strength, const PassContext& context);

/// Sets the uniforms of detail_octaves.glsl, of the program in use.
void setDetailOctaves(const gl::Program& program, const Camera& camera);

}  // namespace terrane

#pragma once
// Draws what the ground looks like below its mesh, as a factor on the picture: noise in octaves of power-of-two
// wavelengths, chosen pixel by pixel so that the finest is a few pixels long (client/shaders/detail.frag.glsl). It asks
// the picture's depth for the ground's place, not the tiles, so that it costs the same whatever the triangles, knows no
// tile borders and no levels, and lies still: a texel is where it is in the body, to within 2^-22 of its distance from
// the camera plus 2^-23 of its wavelength (common/numerics/octave_coordinates.h). GL thread only.

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "client/gl/objects.h"
#include "client/gl/shader_program.h"
#include "client/render/effect_factories.h"

namespace terrane {

/// Wavelengths 2^-13 m (0.12 mm) to 2^18 m (262 km).
inline constexpr int kFinestDetailExponent = -13, kDetailOctaves = 32;

/// By octave, finest first.
struct DetailStrength {
  std::array<float, kDetailOctaves> slopes{};   ///< of the relief
  std::array<float, kDetailOctaves> mottles{};  ///< of the reflectance, a share
  /// The shortest wavelength that is shown, fading in up to twice that. Below two pixels it would shimmer.
  float finestPixels = 2.5f;
};

class DetailPass final : public EffectPass {
 public:
  /// Errors: Unsupported ("shader").
  static Result<std::unique_ptr<DetailPass>> create(const DetailStrength& strength, const EffectList& effects,
                                                    const gl::Capabilities& capabilities);

  void draw(const GroundPicture& picture) override;

 private:
  DetailPass(const DetailStrength& strength, const gl::Capabilities& capabilities)
      : strength_(strength), capabilities_(capabilities) {}
  Result<gl::Program> build(const EffectList& effects, bool multisampled) const;

  DetailStrength strength_;
  gl::Capabilities capabilities_;
  std::optional<gl::Program> program_, multisampledProgram_;  ///< the second when first asked for
  gl::VertexArray noVertices_;
  bool reported_ = false;
};

/// Sets a program's uniforms of ground_position.glsl and binds the target's depth.
void setGroundPosition(const gl::Program& program, const GroundPicture& picture);
/// Sets those of detail_octaves.glsl.
void setDetailOctaves(const gl::Program& program, const Camera& camera);

}  // namespace terrane

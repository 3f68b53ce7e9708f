#pragma once
// One variant of the tile shader: a placement, a purpose, and whether tiles morph, with its uniforms. GL thread only.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/gl/shader_program.h"
#include "client/render/effect_factories.h"
#include "client/render/placement.h"
#include "client/render/tile_draw.h"
#include "client/render/tile_renderer.h"
#include "common/numerics/relative_position.h"

namespace terrane {

enum class TilePurpose : std::uint8_t {
  Shaded,     ///< with the scene's effects
  Coverage,   ///< what covers a pixel
  Positions,  ///< clip positions captured, nothing drawn
  Shading,    ///< what Shaded interpolates captured, nothing drawn
};
inline constexpr int kTilePurposeCount = 4;
inline constexpr int kPlacementCount = 4;

/// Light on the display of what reflects kColorScale in full light, on the display's curve.
float displayExposure() noexcept;

/// Hues a golden angle apart, so that neighbouring levels differ.
glm::vec3 levelTint(int level) noexcept;

struct TileVariant {
  Placement placement = Placement::Integer;
  TilePurpose purpose = TilePurpose::Shaded;
  bool morphs = false;  ///< reads the parent too; tiles that are drawn as they are need not pay for it
};

class TileProgram {
 public:
  /// Errors: Unsupported ("shader").
  static Result<TileProgram> build(const TileVariant& variant, const EffectList& effects,
                                   const gl::Capabilities& capabilities);

  /// Makes it current for this camera. viewportScale: how much larger the viewport is than the picture (guard_band.h).
  void begin(const Camera& camera, const EffectList& effects, double viewportScale);
  /// Makes it current again in the same pass.
  void resume() const { program_.use(); }
  /// Sets a tile's uniforms and binds its array. False if this placement cannot reach the tile (Integer, absurdly far).
  bool place(const TileDraw& draw, std::vector<float>& scratch);
  void setTint(const glm::vec3& displayColor) const;
  void setMark(float value) const;

 private:
  TileProgram(gl::Program program, const TileVariant& variant);
  void placeCamera(int stepExponent);
  void setMorph(const TileDraw& draw) const;

  gl::Program program_;
  TileVariant variant_;
  gl::Uniform clipRows_, nearMeters_, exposure_, tint_, mark_;
  gl::Uniform stepMeters_, originMinusCamera_, cameraRest_, originHigh_, originLow_, cameraHigh_, cameraLow_;
  gl::Uniform morphGrid_, firstInHalfCells_, morphByBorders_, parentMinusOwn_, cameraOdd_, parentCameraRest_,
      parentOriginHigh_, parentOriginLow_;

  glm::dvec3 cameraBody_{0.0};
  std::optional<int> stepExponent_;  ///< whose camera values are set
  CameraOnLattice camera_;
};

}  // namespace terrane

#pragma once
// One variant of the tile shader: a placement and a purpose, with its uniforms. GL thread only.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/gl/shader_program.h"
#include "client/render/effect_factories.h"
#include "client/render/gpu_tiles.h"
#include "client/render/placement.h"
#include "client/render/tile_renderer.h"
#include "common/numerics/relative_position.h"

namespace terrane {

enum class TilePurpose : std::uint8_t {
  Shaded,    ///< with the scene's effects
  Coverage,  ///< what covers a pixel
  Feedback,  ///< clip positions captured, nothing drawn
};
inline constexpr int kTilePurposeCount = 3;
inline constexpr int kPlacementCount = 4;

using EffectList = std::vector<std::unique_ptr<const Effect>>;

class TileProgram {
 public:
  /// Errors: Unsupported ("shader").
  static Result<TileProgram> build(Placement placement, TilePurpose purpose, const EffectList& effects,
                                   const gl::Capabilities& capabilities);

  /// Makes it current for this camera.
  void begin(const Camera& camera, const EffectList& effects);
  /// Sets a tile's uniforms and binds its array. False if this placement cannot reach the tile (Integer, absurdly far).
  bool place(GpuTile& tile, std::vector<float>& scratch);
  void setTint(const glm::vec3& displayColor) const;
  void setMark(float value) const;

 private:
  TileProgram(gl::Program program, Placement placement, TilePurpose purpose);

  gl::Program program_;
  Placement placement_;
  TilePurpose purpose_;
  gl::Uniform clipRows_, nearMeters_, exposure_, tint_, mark_;
  gl::Uniform stepMeters_, originMinusCamera_, cameraRest_, originHigh_, originLow_, cameraHigh_, cameraLow_;

  glm::dvec3 cameraBody_{0.0};
  std::optional<int> stepExponent_;  ///< whose camera values are set
  CameraOnLattice camera_;
};

}  // namespace terrane

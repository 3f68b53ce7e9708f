#pragma once
// What an effect draws of its own over the ground, once a frame, after the tiles. GL thread only.

#include <cstddef>
#include <span>

#include "client/render/effect_factories.h"
#include "client/render/tile_draw.h"
#include "common/view/camera.h"

namespace terrane {

struct SelfTestReport;

/// What a pass may build on; outlives it.
struct PassContext {
  const gl::Capabilities& capabilities;
  const SelfTestReport& selfTest;
  const EffectList& effects;  ///< all of the scene's, for programs that are lit as the ground is
  double bodyRadiusMeters = 0;
  Scheme bodyScheme = Scheme::Cube;
};

struct PassStats {
  std::size_t triangles = 0, drawCalls = 0;
};

class EffectPass {
 public:
  virtual ~EffectPass() = default;
  /// Into the framebuffer that is bound and holds the tiles' colour and depth, with their state (reversed depth test,
  /// back faces culled) set, and again when it returns. tiles: those that were drawn.
  virtual PassStats draw(const Camera& camera, std::span<const TileDraw> tiles) = 0;
  virtual std::size_t gpuBytes() const noexcept = 0;
};

}  // namespace terrane

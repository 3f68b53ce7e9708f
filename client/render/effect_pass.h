#pragma once
// What an effect draws of its own over the ground, once a frame, after the tiles. GL thread only.

#include <cstddef>
#include <span>

#include "client/render/body_picture.h"
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
};

struct PassStats {
  std::size_t triangles = 0, drawCalls = 0;
};

class EffectPass {
 public:
  virtual ~EffectPass() = default;
  /// Once a frame for every body. Into the framebuffer that is bound and holds all tiles' colour and depth, with their
  /// state (reversed depth test, back faces culled) set, and again when it returns. tiles: those of this body that were
  /// drawn; the camera is in its frame.
  virtual PassStats draw(const Camera& camera, std::span<const TileDraw> tiles, const PassBody& body) = 0;
  virtual std::size_t gpuBytes() const noexcept = 0;
};

}  // namespace terrane

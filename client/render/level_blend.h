#pragma once
// Transition::Blend: the parents' surfaces of the tiles that are in between, drawn into a picture of its own with each
// tile's share as alpha, and mixed over the picture of the tiles' own surfaces. Only made where that is asked for
// (constructionCounts: "transition.blend"). GL thread only.

#include <optional>

#include "client/gl/capabilities.h"
#include "client/gl/objects.h"
#include "client/gl/render_target.h"
#include "client/gl/shader_program.h"
#include "common/result.h"

namespace terrane {

class LevelBlend {
 public:
  /// Errors: Unsupported ("shader").
  static Result<LevelBlend> create(const gl::Capabilities& capabilities);

  /// Binds the second picture, as large and with as many samples as the one that is bound. False if the driver refuses.
  bool bind(int widthPixels, int heightPixels);
  /// After the pass has cleared: what is drawn from here on writes its share, 0..1, as alpha.
  static void beginTiles();
  static void setShare(float share);
  static void endTiles();
  /// Over the colour of the framebuffer that bind found bound, which is bound again; its alpha is kept.
  void mix() const;

 private:
  explicit LevelBlend(gl::Program program) : program_(std::move(program)) {}

  gl::Program program_;
  gl::VertexArray noVertices_;
  std::optional<RenderTarget> target_;
  unsigned below_ = 0;
};

}  // namespace terrane

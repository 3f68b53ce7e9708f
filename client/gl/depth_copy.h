#pragma once
// A copy of the depth buffer of whatever framebuffer is bound, as a texture: so that a pass can read how far away the
// scene is while it draws into the same framebuffer. GL thread only.

#include <cstddef>

#include "client/gl/objects.h"

namespace terrane::gl {

class DepthCopy {
 public:
  /// Copies the depth, 32-bit float, of the framebuffer that is bound; of several samples a pixel one. False if the
  /// driver refuses.
  bool take(int widthPixels, int heightPixels);
  /// As the sampler2D of unit 0.
  void bind() const;
  std::size_t bytes() const noexcept;

 private:
  int widthPixels_ = 0, heightPixels_ = 0;
  bool complete_ = false;
  Handle<ObjectKind::Texture> depth_;
  Handle<ObjectKind::Framebuffer> framebuffer_;
};

}  // namespace terrane::gl

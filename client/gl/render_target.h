#pragma once
// An offscreen framebuffer of exact size: colour of 8 bits a channel and a 32-bit float depth buffer, without which
// reversed depth would be worth nothing (a window's own depth buffer has 24 fixed bits). GL thread only.

#include <cstdint>
#include <vector>

#include "client/gl/objects.h"
#include "common/result.h"

namespace terrane {

enum class TargetFormat : std::uint8_t { Rgba8, R8 };

class RenderTarget {
 public:
  /// Errors: TooLarge, Unsupported ("framebuffer").
  static Result<RenderTarget> create(int widthPixels, int heightPixels, TargetFormat format = TargetFormat::Rgba8);

  int widthPixels() const noexcept { return widthPixels_; }
  int heightPixels() const noexcept { return heightPixels_; }

  /// For drawing and reading; sets the viewport.
  void bind() const;
  /// Binds the window's own framebuffer again.
  static void bindWindow();
  /// Copies the colour to the window's framebuffer, scaled if the sizes differ, and leaves that bound.
  void blitToWindow(int windowWidthPixels, int windowHeightPixels) const;
  /// Red bytes, bottom row first.
  std::vector<std::uint8_t> readRed() const;

 private:
  RenderTarget() = default;
  int widthPixels_ = 0, heightPixels_ = 0;
  gl::Handle<gl::ObjectKind::Framebuffer> framebuffer_;
  gl::Handle<gl::ObjectKind::Renderbuffer> color_, depth_;
};

}  // namespace terrane

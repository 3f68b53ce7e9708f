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
  /// samples: a pixel, for smooth edges; 1 is none. More than the driver has gives the most that it has (samples(),
  /// Capabilities::maxSamples). Errors: TooLarge, Unsupported ("framebuffer").
  static Result<RenderTarget> create(int widthPixels, int heightPixels, TargetFormat format = TargetFormat::Rgba8,
                                     int samples = 1);

  int widthPixels() const noexcept { return widthPixels_; }
  int heightPixels() const noexcept { return heightPixels_; }
  int samples() const noexcept { return samples_; }
  /// What create would make of these, but for the format.
  bool isLike(int widthPixels, int heightPixels, int samplesAsked) const noexcept {
    return widthPixels == widthPixels_ && heightPixels == heightPixels_ && samplesAsked == samplesAsked_;
  }

  /// For drawing, and for reading where there is one sample; sets the viewport.
  void bind() const;
  /// For reading (readFramebuffer): brings every pixel's samples together first. Drawing goes where bind sends it.
  void bindForReading() const;
  /// Colour as a sampler2D, as of the last bindForReading or blitToWindow where there are several samples.
  void bindColorTexture(int unit) const;

  /// Binds the window's own framebuffer again.
  static void bindWindow();
  /// Copies the colour to the window's framebuffer, scaled if the sizes differ, and leaves that bound.
  void blitToWindow(int windowWidthPixels, int windowHeightPixels) const;
  /// Red bytes, bottom row first.
  std::vector<std::uint8_t> readRed() const;

 private:
  RenderTarget() = default;
  Result<bool> attach(TargetFormat format);
  unsigned readable() const noexcept { return resolved_ ? resolved_.id() : framebuffer_.id(); }

  int widthPixels_ = 0, heightPixels_ = 0, samples_ = 1, samplesAsked_ = 1;
  gl::Handle<gl::ObjectKind::Texture> color_;
  gl::Handle<gl::ObjectKind::Renderbuffer> depth_, sampledColor_;  ///< the second only with several samples
  gl::Handle<gl::ObjectKind::Framebuffer> framebuffer_, resolved_;
};

}  // namespace terrane

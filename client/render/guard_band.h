#pragma once
// Room around the picture in which software GL need not clip triangles. Mesa's llvmpipe clips at the viewport's edges,
// and where it clips any triangle of a batch it culls all of them by where they face before their corners are snapped
// to sub-pixels; one seen along its plane may face the camera only after that, and its pixels would stay open. So the
// viewport reaches far beyond the framebuffer, and the few tiles that are clipped even so, those around the camera, are
// not culled (culling none at all costs software GL a good part of a frame). tests/capture/tile_pass_test.cpp shows
// both. GL thread only.

#include <optional>

#include "client/gl/capabilities.h"
#include "common/tiling/tile_bounds.h"
#include "common/view/camera.h"
#include "common/view/frustum.h"

namespace terrane {

class GuardBand {
 public:
  /// Sets the viewport, and the camera's back at its end. Does nothing where GL draws on a GPU, which has its own.
  GuardBand(const gl::Capabilities& capabilities, const Camera& camera);
  GuardBand(const GuardBand&) = delete;
  GuardBand& operator=(const GuardBand&) = delete;
  ~GuardBand();

  /// How much larger the viewport is: clip-space x and y are to be divided by it. A power of two, so that what is drawn
  /// stays the same to the bit.
  double scale() const noexcept { return frustum_ ? kScale : 1; }
  /// Culls back faces from now on, unless something in the sphere may be clipped.
  void cullFor(const Sphere& sphereBody) const;

 private:
  static constexpr double kScale = 4;
  int widthPixels_, heightPixels_;
  std::optional<Frustum> frustum_;  ///< of what is not clipped
};

}  // namespace terrane

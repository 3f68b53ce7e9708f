#include "client/render/guard_band.h"

#include <epoxy/gl.h>

namespace terrane {

GuardBand::GuardBand(const gl::Capabilities& capabilities, const Camera& camera)
    : widthPixels_(camera.widthPixels), heightPixels_(camera.heightPixels) {
  constexpr int kFirstVersionWithFloatViewports = 41;
  if (!capabilities.rendersOnCpu || capabilities.version < kFirstVersionWithFloatViewports) return;
  frustum_.emplace(widened(camera, 0.5 * (kScale - 1)));
  const auto width = static_cast<float>(widthPixels_), height = static_cast<float>(heightPixels_);
  constexpr auto kScaled = static_cast<float>(kScale);
  glViewportIndexedf(0, 0.5f * (1 - kScaled) * width, 0.5f * (1 - kScaled) * height, kScaled * width, kScaled * height);
}

GuardBand::~GuardBand() {
  if (frustum_) glViewport(0, 0, widthPixels_, heightPixels_);
}

void GuardBand::cullFor(const Sphere& sphereBody) const {
  if (!frustum_) return;
  if (frustum_->contains(sphereBody)) {
    glEnable(GL_CULL_FACE);
  } else {
    glDisable(GL_CULL_FACE);
  }
}

}  // namespace terrane

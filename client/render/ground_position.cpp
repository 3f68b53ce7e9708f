#include "client/render/ground_position.h"

#include "client/render/clip_rows.h"

namespace terrane {

void setGroundPosition(const gl::Program& program, const Camera& camera) {
  setUniform(program.uniform("groundDepth"), 0);
  setUniform(program.uniform("rays"), glm::mat3(screenRays(camera)));
  setUniform(program.uniform("pictureSize"), glm::vec2(camera.widthPixels, camera.heightPixels));
  setUniform(program.uniform("nearMeters"), static_cast<float>(camera.nearMeters));
}

}  // namespace terrane

#include "client/render/tile_pass.h"

#include <epoxy/gl.h>

#include "client/gl/objects.h"

namespace terrane {

TilePass::TilePass(const gl::Capabilities& capabilities, bool wireframe, Start start)
    : clipControl_(capabilities.clipControl) {
  if (clipControl_) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_DEPTH_TEST);
  // Not GREATER: a triangle that snapping to sub-pixels leaves hardly any area has depth extrapolated from slopes of
  // any size, perhaps clamped to 0. Its pixel is ground all the same.
  glDepthFunc(GL_GEQUAL);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glPolygonMode(GL_FRONT_AND_BACK, wireframe ? GL_LINE : GL_FILL);
  glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  glClearDepth(0.0);
  if (start == Start::Cleared) glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

TilePass::~TilePass() {
  if (clipControl_) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClearDepth(1.0);
  gl::VertexArray::unbind();
  glUseProgram(0);
}

}  // namespace terrane

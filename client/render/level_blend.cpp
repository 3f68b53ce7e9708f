#include "client/render/level_blend.h"

#include <epoxy/gl.h>

#include "common/scene/effects.h"

namespace terrane {

Result<LevelBlend> LevelBlend::create(const gl::Capabilities& capabilities) {
  auto program = gl::Program::build({.vertexFile = "whole_picture.vert.glsl", .fragmentFile = "copy_picture.frag.glsl"},
                                    capabilities);
  if (!program) return program.error();
  countConstruction("transition.blend");
  return LevelBlend(std::move(*program));
}

bool LevelBlend::bind(int widthPixels, int heightPixels) {
  GLint below = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &below);
  below_ = static_cast<unsigned>(below);
  const int samples = gl::boundSamples();
  if (!target_ || !target_->isLike(widthPixels, heightPixels, samples)) {
    target_.reset();
    auto created = RenderTarget::create(widthPixels, heightPixels, TargetFormat::Rgba8, samples);
    if (!created) return false;
    target_.emplace(std::move(*created));
  }
  target_->bind();
  return true;
}

void LevelBlend::beginTiles() {
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_BLEND);
  // The tiles' shader writes an alpha of 1.
  glBlendFuncSeparate(GL_ONE, GL_ZERO, GL_CONSTANT_ALPHA, GL_ZERO);
}

void LevelBlend::setShare(float share) { glBlendColor(0.0f, 0.0f, 0.0f, share); }

void LevelBlend::endTiles() {
  glDisable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ZERO);
}

void LevelBlend::mix() const {
  target_->bindForReading();
  glBindFramebuffer(GL_FRAMEBUFFER, below_);
  target_->bindColorTexture(0);
  program_.use();
  noVertices_.bind();
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ZERO);
  gl::VertexArray::unbind();
  glUseProgram(0);
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace terrane

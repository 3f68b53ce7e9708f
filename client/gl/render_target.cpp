#include "client/gl/render_target.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace terrane {

Result<RenderTarget> RenderTarget::create(int widthPixels, int heightPixels, TargetFormat format) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  if (widthPixels < 1 || heightPixels < 1 || widthPixels > limit || heightPixels > limit) {
    return makeError(ErrorKind::TooLarge, "framebuffer",
                     fmt::format("{}x{} pixels; this driver allows 1 to {} a side", widthPixels, heightPixels, limit));
  }
  RenderTarget target;
  target.widthPixels_ = widthPixels;
  target.heightPixels_ = heightPixels;
  GLuint ids[2] = {};
  glGenRenderbuffers(2, ids);
  target.color_ = gl::Handle<gl::ObjectKind::Renderbuffer>(ids[0]);
  target.depth_ = gl::Handle<gl::ObjectKind::Renderbuffer>(ids[1]);
  glBindRenderbuffer(GL_RENDERBUFFER, ids[0]);
  glRenderbufferStorage(GL_RENDERBUFFER, format == TargetFormat::R8 ? GL_R8 : GL_RGBA8, widthPixels, heightPixels);
  glBindRenderbuffer(GL_RENDERBUFFER, ids[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, widthPixels, heightPixels);

  GLuint framebuffer = 0;
  GLint previous = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &previous);
  glGenFramebuffers(1, &framebuffer);
  target.framebuffer_ = gl::Handle<gl::ObjectKind::Framebuffer>(framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, ids[0]);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, ids[1]);
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(previous));
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    return makeError(ErrorKind::Unsupported, "framebuffer",
                     fmt::format("the driver refuses it (status {:#x})", status));
  }
  return target;
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, widthPixels_, heightPixels_);
}

void RenderTarget::bindWindow() { glBindFramebuffer(GL_FRAMEBUFFER, 0); }

void RenderTarget::blitToWindow(int windowWidthPixels, int windowHeightPixels) const {
  const bool sameSize = windowWidthPixels == widthPixels_ && windowHeightPixels == heightPixels_;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, widthPixels_, heightPixels_, 0, 0, windowWidthPixels, windowHeightPixels, GL_COLOR_BUFFER_BIT,
                    sameSize ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, windowWidthPixels, windowHeightPixels);
}

std::vector<std::uint8_t> RenderTarget::readRed() const {
  std::vector<std::uint8_t> red(static_cast<std::size_t>(widthPixels_) * static_cast<std::size_t>(heightPixels_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, widthPixels_, heightPixels_, GL_RED, GL_UNSIGNED_BYTE, red.data());
  return red;
}

}  // namespace terrane

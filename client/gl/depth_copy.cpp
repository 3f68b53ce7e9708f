#include "client/gl/depth_copy.h"

#include <epoxy/gl.h>

namespace terrane::gl {

bool DepthCopy::take(int widthPixels, int heightPixels) {
  GLint source = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &source);
  if (widthPixels != widthPixels_ || heightPixels != heightPixels_) {
    widthPixels_ = widthPixels;
    heightPixels_ = heightPixels;
    GLuint texture = 0, framebuffer = 0;
    glGenTextures(1, &texture);
    depth_ = Handle<ObjectKind::Texture>(texture);
    bind();
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, widthPixels, heightPixels, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                 nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glGenFramebuffers(1, &framebuffer);
    framebuffer_ = Handle<ObjectKind::Framebuffer>(framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    complete_ = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }
  if (complete_) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(source));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.id());
    glBlitFramebuffer(0, 0, widthPixels, heightPixels, 0, 0, widthPixels, heightPixels, GL_DEPTH_BUFFER_BIT,
                      GL_NEAREST);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(source));
  return complete_;
}

void DepthCopy::bind() const {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, depth_.id());
}

std::size_t DepthCopy::bytes() const noexcept {
  return sizeof(float) * static_cast<std::size_t>(widthPixels_) * static_cast<std::size_t>(heightPixels_);
}

}  // namespace terrane::gl

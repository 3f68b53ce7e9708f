#include "client/gl/render_target.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

#include "client/gl/capabilities.h"

namespace terrane {
namespace {

using Framebuffer = gl::Handle<gl::ObjectKind::Framebuffer>;
using Renderbuffer = gl::Handle<gl::ObjectKind::Renderbuffer>;
using Texture = gl::Handle<gl::ObjectKind::Texture>;

struct Shape {
  int widthPixels, heightPixels, samples;
};

/// Read by texel: no mipmaps, nothing between texels.
Texture makeTexture(GLenum internalFormat, GLenum format, int widthPixels, int heightPixels) {
  GLuint id = 0;
  glGenTextures(1, &id);
  Texture texture(id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internalFormat), widthPixels, heightPixels, 0, format,
               GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

Renderbuffer makeRenderbuffer(GLenum internalFormat, const Shape& shape) {
  GLuint id = 0;
  glGenRenderbuffers(1, &id);
  glBindRenderbuffer(GL_RENDERBUFFER, id);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, shape.samples > 1 ? shape.samples : 0, internalFormat,
                                   shape.widthPixels, shape.heightPixels);
  return Renderbuffer(id);
}

/// Leaves it bound.
Framebuffer makeFramebuffer() {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  return Framebuffer(id);
}

}  // namespace

Result<RenderTarget> RenderTarget::create(int widthPixels, int heightPixels, TargetFormat format, int samples) {
  GLint renderbuffers = 0, textures = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &renderbuffers);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &textures);
  const int limit = std::min(renderbuffers, textures);
  if (widthPixels < 1 || heightPixels < 1 || widthPixels > limit || heightPixels > limit) {
    return makeError(ErrorKind::TooLarge, "framebuffer",
                     fmt::format("{}x{} pixels; this driver allows 1 to {} a side", widthPixels, heightPixels, limit));
  }
  RenderTarget target;
  target.widthPixels_ = widthPixels;
  target.heightPixels_ = heightPixels;
  target.samplesAsked_ = samples;
  target.samples_ = std::clamp(samples, 1, gl::maxSamples());
  GLint previous = 0;
  glGetIntegerv(GL_FRAMEBUFFER_BINDING, &previous);
  const auto attached = target.attach(format);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(previous));
  if (!attached) return attached.error();
  return target;
}

/// Makes the framebuffers and what they show. Leaves one of them bound.
Result<bool> RenderTarget::attach(TargetFormat format) {
  const bool red = format == TargetFormat::R8;
  const GLenum colorFormat = red ? GL_R8 : GL_RGBA8;
  const Shape shape{widthPixels_, heightPixels_, samples_};
  color_ = makeTexture(colorFormat, red ? GL_RED : GL_RGBA, widthPixels_, heightPixels_);
  depth_ = makeRenderbuffer(GL_DEPTH_COMPONENT32F, shape);
  if (samples_ > 1) sampledColor_ = makeRenderbuffer(colorFormat, shape);

  GLenum status = GL_FRAMEBUFFER_COMPLETE;
  const auto finish = [&](Framebuffer& framebuffer, bool sampled, bool depth) {
    framebuffer = makeFramebuffer();
    if (sampled)
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, sampledColor_.id());
    else
      glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, color_.id(), 0);
    if (depth) glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
    const GLenum found = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) status = found;
  };
  if (samples_ > 1) finish(resolved_, false, false);
  finish(framebuffer_, samples_ > 1, true);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    return makeError(ErrorKind::Unsupported, "framebuffer",
                     fmt::format("the driver refuses it (status {:#x})", status));
  }
  // A driver may give more samples than were asked for.
  samples_ = gl::boundSamples();
  return true;
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, widthPixels_, heightPixels_);
}

void RenderTarget::bindForReading() const {
  if (resolved_) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_.id());
    glBlitFramebuffer(0, 0, widthPixels_, heightPixels_, 0, 0, widthPixels_, heightPixels_, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.id());
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, readable());
}

void RenderTarget::bindColorTexture(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, color_.id());
  glActiveTexture(GL_TEXTURE0);
}

void RenderTarget::bindWindow() { glBindFramebuffer(GL_FRAMEBUFFER, 0); }

void RenderTarget::blitToWindow(int windowWidthPixels, int windowHeightPixels) const {
  const bool sameSize = windowWidthPixels == widthPixels_ && windowHeightPixels == heightPixels_;
  // By way of the resolved colour: straight from several samples GL allows neither scaling nor another format.
  bindForReading();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, widthPixels_, heightPixels_, 0, 0, windowWidthPixels, windowHeightPixels, GL_COLOR_BUFFER_BIT,
                    sameSize ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, windowWidthPixels, windowHeightPixels);
}

std::vector<std::uint8_t> RenderTarget::readRed() const {
  std::vector<std::uint8_t> red(static_cast<std::size_t>(widthPixels_) * static_cast<std::size_t>(heightPixels_));
  bindForReading();
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, widthPixels_, heightPixels_, GL_RED, GL_UNSIGNED_BYTE, red.data());
  return red;
}

}  // namespace terrane

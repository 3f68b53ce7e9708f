#include "client/gl/capabilities.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace terrane::gl {
namespace {

std::string glText(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text != nullptr ? text : "";
}

bool isSoftwareRenderer(std::string_view renderer) {
  constexpr std::array<std::string_view, 4> kNames{"llvmpipe", "softpipe", "swrast", "SwiftShader"};
  return std::ranges::any_of(kNames, [&](std::string_view name) { return renderer.find(name) != renderer.npos; });
}

const char* errorName(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "OUT_OF_MEMORY";
    default:
      return "unknown error";
  }
}

}  // namespace

Capabilities detectCapabilities(bool forceBaseline) {
  Capabilities found;
  found.renderer = glText(GL_RENDERER);
  found.versionText = glText(GL_VERSION);
  found.rendersOnCpu = isSoftwareRenderer(found.renderer);
  found.maxSamples = maxSamples();
  if (forceBaseline) return found;
  found.version = epoxy_gl_version();
  found.shadingLanguage = found.version >= 45 ? 450 : found.version >= 40 ? 400 : 330;
  found.clipControl = found.version >= 45 || epoxy_has_gl_extension("GL_ARB_clip_control");
  found.preciseByExtension = found.version < 40 && epoxy_has_gl_extension("GL_ARB_gpu_shader5");
  found.precise = found.version >= 40 || found.preciseByExtension;
  GLint words = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &words);
  found.bufferWords = std::max(found.bufferWords, static_cast<std::size_t>(std::max(words, 0)));
  return found;
}

int maxSamples() {
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  return std::max(1, most);
}

int boundSamples() {
  GLint samples = 0;
  glGetIntegerv(GL_SAMPLES, &samples);
  return std::max(1, samples);
}

std::string takeErrors() {
  std::string names;
  // A lost context reports an error for ever: stop after as many as could be meant.
  for (int i = 0; i < 16; ++i) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) break;
    if (!names.empty()) names += ", ";
    names += errorName(error);
  }
  return names;
}

}  // namespace terrane::gl

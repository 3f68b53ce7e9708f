#pragma once
// What the current GL context offers of the few things that Terrane asks for beyond 3.3 core. GL thread only.

#include <cstddef>
#include <string>

namespace terrane::gl {

struct Capabilities {
  int version = 33;           ///< 10 * major + minor
  int shadingLanguage = 330;  ///< the #version that programs are compiled with
  bool clipControl = false;   ///< depth 0..1, for reversed depth without loss
  bool precise = false;  ///< the shading language has the qualifier that forbids rewriting floating-point expressions
  bool preciseByExtension = false;
  std::size_t bufferWords = 65536;  ///< that a shader can read of a buffer
  bool rendersOnCpu = false;        ///< software GL: what it holds back of a frame is the program's own memory
  int maxSamples = 1;               ///< a pixel, of a render target
  std::string renderer, versionText;
};

/// forceBaseline: report bare 3.3 whatever the context has, so that the baseline path can be tested anywhere.
Capabilities detectCapabilities(bool forceBaseline = false);

/// Capabilities::maxSamples, asked anew.
int maxSamples();
/// Samples a pixel of the framebuffer that is bound for drawing.
int boundSamples();

/// Names of the GL errors raised since the last call ("INVALID_OPERATION"), empty when there are none.
std::string takeErrors();

}  // namespace terrane::gl

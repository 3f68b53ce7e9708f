#include "tests/support/vertex_run.h"

#include <epoxy/gl.h>

#include "client/gl/capabilities.h"

namespace terrane::test {

Result<VertexRun> VertexRun::create(const Spec& spec) {
  auto program = gl::Program::build({.vertexFile = {},
                                     .vertexText = spec.vertexText,
                                     .fragmentFile = {},
                                     .defines = spec.defines,
                                     .feedbackVaryings = spec.varyings},
                                    gl::detectCapabilities());
  if (!program) return program.error();
  return VertexRun(std::move(*program), spec.floatsPerVertex);
}

void VertexRun::setVertices(std::span<const std::byte> vertices, std::size_t stride,
                            std::span<const gl::VertexAttribute> attributes) {
  vertexCount_ = vertices.size() / stride;
  in_.upload(gl::BufferTarget::Vertices, vertices, gl::BufferUse::Static);
  array_.attach(in_, stride, attributes);
  out_.allocate(gl::BufferTarget::Feedback, vertexCount_ * floatsPerVertex_ * sizeof(float), gl::BufferUse::ReadBack);
}

void VertexRun::replaceVertices(std::span<const std::byte> vertices) {
  in_.upload(gl::BufferTarget::Vertices, vertices, gl::BufferUse::Stream);
}

void VertexRun::run() {
  program_.use();
  array_.bind();
  out_.bindForFeedback();
  glEnable(GL_RASTERIZER_DISCARD);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(vertexCount_));
  glEndTransformFeedback();
  glDisable(GL_RASTERIZER_DISCARD);
  glFinish();
}

std::vector<float> VertexRun::results() const {
  std::vector<float> values(vertexCount_ * floatsPerVertex_);
  out_.read(0, std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace terrane::test

#pragma once
// A vertex shader run for its numbers: vertices in, floats out by transform feedback, nothing drawn. GL thread only; a
// context must be current.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/gl/objects.h"
#include "client/gl/shader_program.h"
#include "common/result.h"

namespace terrane::test {

class VertexRun {
 public:
  struct Spec {
    std::string_view vertexText = {};  ///< may include the project's shader files
    std::vector<std::string> defines = {};
    std::vector<const char*> varyings = {};  ///< floats
    std::size_t floatsPerVertex = 0;         ///< in all varyings together
  };
  /// Errors: Unsupported ("shader").
  static Result<VertexRun> create(const Spec& spec);

  /// Replaces the vertices, interleaved.
  void setVertices(std::span<const std::byte> vertices, std::size_t stride,
                   std::span<const gl::VertexAttribute> attributes);
  /// As many as before, of the same layout: what is uploaded for every frame.
  void replaceVertices(std::span<const std::byte> vertices);
  const gl::Program& program() const noexcept { return program_; }
  /// Runs over all vertices and waits until that is done. Uniforms keep what they were set to.
  void run();
  /// What the last run gave, vertex by vertex.
  std::vector<float> results() const;

 private:
  VertexRun(gl::Program program, std::size_t floatsPerVertex)
      : program_(std::move(program)), floatsPerVertex_(floatsPerVertex) {}

  gl::Program program_;
  std::size_t floatsPerVertex_, vertexCount_ = 0;
  gl::Buffer in_, out_;
  gl::VertexArray array_;
};

}  // namespace terrane::test

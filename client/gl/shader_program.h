#pragma once
// Shader programs from the GLSL files that were built into the binary (client/shaders). GL thread only.

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/gl/capabilities.h"
#include "client/gl/objects.h"
#include "common/result.h"

namespace terrane::gl {

/// A file of client/shaders by its name ("tile.vert.glsl"); empty if there is none.
std::string_view shaderSource(std::string_view fileName) noexcept;

/// A uniform of one program. Setting one that the program does not use does nothing.
struct Uniform {
  int location = -1;
};

struct ProgramSpec {
  std::string_view vertexFile = {};
  std::string_view vertexText = {};                ///< in place of a file; may include files
  std::string_view fragmentFile = {};              ///< empty, as its text: vertices only (transform feedback)
  std::string_view fragmentText = {};              ///< in place of a file; may include files
  std::vector<std::string> defines = {};           ///< "NAME" or "NAME value"
  std::vector<const char*> feedbackVaryings = {};  ///< captured, interleaved
};

class Program {
 public:
  /// Every file sees PRECISE (the qualifier, or nothing where the language lacks it) and the defines. #include "file"
  /// works. Errors: Unsupported ("shader", with the driver's log).
  static Result<Program> build(const ProgramSpec& spec, const Capabilities& capabilities);

  void use() const;
  Uniform uniform(const char* name) const;

 private:
  explicit Program(Handle<ObjectKind::Program> handle) : handle_(std::move(handle)) {}
  Handle<ObjectKind::Program> handle_;
};

/// Of the program in use.
void setUniform(Uniform uniform, float value);
void setUniform(Uniform uniform, const glm::vec2& value);
void setUniform(Uniform uniform, const glm::vec3& value);
void setUniform(Uniform uniform, const glm::vec4& value);
void setUniform(Uniform uniform, const glm::ivec2& value);
void setUniform(Uniform uniform, const glm::ivec3& value);
void setUniform(Uniform uniform, const glm::mat3& value);
void setUniform(Uniform uniform, int value);
/// Arrays.
void setUniform(Uniform uniform, std::span<const float> values);
void setUniform(Uniform uniform, std::span<const glm::vec4> values);
void setUniform(Uniform uniform, std::span<const glm::ivec3> values);

}  // namespace terrane::gl

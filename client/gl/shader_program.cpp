#include "client/gl/shader_program.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <glm/gtc/type_ptr.hpp>

namespace terrane::gl {
namespace {

constexpr int kMaxIncludeDepth = 4;

Error shaderError(std::string_view file, std::string_view log) {
  return makeError(ErrorKind::Unsupported, "shader", fmt::format("{}: {}", file, log));
}

/// Appends a source with its #include lines replaced. The sources are the project's own, so a line either starts with
/// #include or not.
bool appendSource(std::string_view source, int depth, std::string& out) {
  if (source.empty() || depth > kMaxIncludeDepth) return false;
  constexpr std::string_view kInclude = "#include \"";
  while (!source.empty()) {
    const std::size_t end = source.find('\n');
    std::string_view line = source.substr(0, end);
    source.remove_prefix(end == std::string_view::npos ? source.size() : end + 1);
    if (line.substr(0, kInclude.size()) == kInclude) {
      line.remove_prefix(kInclude.size());
      if (!appendSource(shaderSource(line.substr(0, line.find('"'))), depth + 1, out)) return false;
    } else {
      out.append(line).push_back('\n');
    }
  }
  return true;
}

std::string prologue(const Capabilities& capabilities, const std::vector<std::string>& defines) {
  std::string text = fmt::format("#version {} core\n", capabilities.shadingLanguage);
  if (capabilities.preciseByExtension) text += "#extension GL_ARB_gpu_shader5 : enable\n";
  // Both came into the language together.
  if (capabilities.precise) text += "#define HAS_PRECISE\n#define HAS_FMA\n";
  text += capabilities.precise ? "#define PRECISE precise\n" : "#define PRECISE\n";
  text += "#define FUNCTION\n";  // of the sources that C++ shares
  if (capabilities.clipControl) text += "#define CLIP_CONTROL\n";
  for (const std::string& define : defines) text += "#define " + define + "\n";
  return text;
}

Result<Handle<ObjectKind::Shader>> compile(GLenum stage, std::string_view file, std::string_view source,
                                           const std::string& head) {
  std::string text = head;
  if (!appendSource(source, 0, text)) return shaderError(file, "not built into this program");
  Handle<ObjectKind::Shader> shader(glCreateShader(stage));
  const char* pointer = text.c_str();
  glShaderSource(shader.id(), 1, &pointer, nullptr);
  glCompileShader(shader.id());
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  return shaderError(file, log);
}

}  // namespace

Result<Program> Program::build(const ProgramSpec& spec, const Capabilities& capabilities) {
  const std::string head = prologue(capabilities, spec.defines);
  Handle<ObjectKind::Program> program(glCreateProgram());
  const std::string_view vertexName = spec.vertexText.empty() ? spec.vertexFile : "vertex shader";
  const std::string_view vertexText = spec.vertexText.empty() ? shaderSource(spec.vertexFile) : spec.vertexText;
  auto vertex = compile(GL_VERTEX_SHADER, vertexName, vertexText, head);
  if (!vertex) return vertex.error();
  glAttachShader(program.id(), vertex->id());
  Handle<ObjectKind::Shader> fragment;
  if (!spec.fragmentFile.empty() || !spec.fragmentText.empty()) {
    const bool isFile = spec.fragmentText.empty();
    auto compiled = compile(GL_FRAGMENT_SHADER, isFile ? spec.fragmentFile : "fragment shader",
                            isFile ? shaderSource(spec.fragmentFile) : spec.fragmentText, head);
    if (!compiled) return compiled.error();
    fragment = std::move(*compiled);
    glAttachShader(program.id(), fragment.id());
  }
  if (!spec.feedbackVaryings.empty()) {
    glTransformFeedbackVaryings(program.id(), static_cast<GLsizei>(spec.feedbackVaryings.size()),
                                spec.feedbackVaryings.data(), GL_INTERLEAVED_ATTRIBS);
  }
  glLinkProgram(program.id());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return shaderError(vertexName, log);
  }
  glDetachShader(program.id(), vertex->id());
  if (fragment) glDetachShader(program.id(), fragment.id());
  return Program(std::move(program));
}

void Program::use() const { glUseProgram(handle_.id()); }

Uniform Program::uniform(const char* name) const { return Uniform{glGetUniformLocation(handle_.id(), name)}; }

void setUniform(Uniform uniform, float value) { glUniform1f(uniform.location, value); }
void setUniform(Uniform uniform, const glm::vec2& value) { glUniform2fv(uniform.location, 1, glm::value_ptr(value)); }
void setUniform(Uniform uniform, const glm::vec3& value) { glUniform3fv(uniform.location, 1, glm::value_ptr(value)); }
void setUniform(Uniform uniform, const glm::vec4& value) { glUniform4fv(uniform.location, 1, glm::value_ptr(value)); }
void setUniform(Uniform uniform, const glm::ivec2& value) { glUniform2iv(uniform.location, 1, glm::value_ptr(value)); }
void setUniform(Uniform uniform, const glm::ivec3& value) { glUniform3iv(uniform.location, 1, glm::value_ptr(value)); }
void setUniform(Uniform uniform, std::span<const float> values) {
  glUniform1fv(uniform.location, static_cast<GLsizei>(values.size()), values.data());
}
void setUniform(Uniform uniform, std::span<const glm::vec4> values) {
  glUniform4fv(uniform.location, static_cast<GLsizei>(values.size()), &values.data()->x);
}
void setUniform(Uniform uniform, std::span<const glm::ivec3> values) {
  glUniform3iv(uniform.location, static_cast<GLsizei>(values.size()), &values.data()->x);
}
void setUniform(Uniform uniform, int value) { glUniform1i(uniform.location, value); }
void setUniform(Uniform uniform, const glm::mat3& value) {
  glUniformMatrix3fv(uniform.location, 1, GL_FALSE, glm::value_ptr(value));
}

}  // namespace terrane::gl

#include "tests/bench/bare_loop.h"

#include <epoxy/gl.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/tiling/lattice.h"

namespace terrane::bench {
namespace {

struct Vertex {
  float position[3];
  float normal[3];
  std::uint8_t color[4];
};

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
uniform mat4 matrix;
out vec3 shadedColor;
void main() {
  shadedColor = color.rgb * max(dot(normal, vec3(0.6, 0.64, 0.48)), 0.0);
  gl_Position = matrix * vec4(position, 1.0);
}
)";
constexpr const char* kFragmentShader = R"(#version 330 core
in vec3 shadedColor;
out vec4 pixel;
void main() { pixel = vec4(shadedColor, 1.0); }
)";

unsigned compile(GLenum kind, const char* source) {
  const unsigned shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  return shader;
}

std::vector<Vertex> cameraRelativeVertices(const Camera& camera, const Tile& tile) {
  const double step = stepMeters(tile.metadata.stepExponent);
  const auto origin = latticePosition(tile.metadata.origin, tile.metadata.stepExponent) - camera.positionBody;
  std::vector<Vertex> vertices(tile.mesh.vertexCount());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = 3 * i + static_cast<std::size_t>(axis);
      vertices[i].position[axis] = static_cast<float>(origin[axis] + step * tile.mesh.offsets[k]);
      vertices[i].normal[axis] = tile.mesh.normals[k];
      vertices[i].color[axis] = tile.mesh.colors.empty() ? std::uint8_t{255} : tile.mesh.colors[k];
    }
  }
  return vertices;
}

}  // namespace

BareLoop::BareLoop(const Camera& camera, const std::vector<std::shared_ptr<const Tile>>& tiles) {
  program_ = glCreateProgram();
  for (const auto& [kind, source] :
       {std::pair{GL_VERTEX_SHADER, kVertexShader}, std::pair{GL_FRAGMENT_SHADER, kFragmentShader}}) {
    const unsigned shader = compile(static_cast<GLenum>(kind), source);
    glAttachShader(program_, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program_);
  matrixLocation_ = glGetUniformLocation(program_, "matrix");
  const glm::dmat4 matrix = reversedInfiniteProjection(camera) * glm::dmat4(viewRotation(camera));
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) matrix_[4 * column + row] = static_cast<float>(matrix[column][row]);
  }
  for (const auto& tile : tiles) {
    Mesh mesh;
    const auto vertices = cameraRelativeVertices(camera, *tile);
    const std::vector<std::uint16_t> indices(tile->mesh.triangles.begin(), tile->mesh.triangles.end());
    mesh.indexCount = static_cast<int>(indices.size());
    glGenVertexArrays(1, &mesh.vertexArray);
    glBindVertexArray(mesh.vertexArray);
    glGenBuffers(1, &mesh.vertices);
    glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                 GL_STATIC_DRAW);
    glGenBuffers(1, &mesh.indices);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * 2), indices.data(), GL_STATIC_DRAW);
    const auto pointer = [](unsigned index, int size, GLenum type, bool normalized, std::size_t offset) {
      glEnableVertexAttribArray(index);
      glVertexAttribPointer(index, size, type, normalized ? GL_TRUE : GL_FALSE, sizeof(Vertex),
                            reinterpret_cast<const void*>(offset));
    };
    pointer(0, 3, GL_FLOAT, false, offsetof(Vertex, position));
    pointer(1, 3, GL_FLOAT, false, offsetof(Vertex, normal));
    pointer(2, 4, GL_UNSIGNED_BYTE, true, offsetof(Vertex, color));
    meshes_.push_back(mesh);
  }
  glBindVertexArray(0);
}

BareLoop::~BareLoop() {
  for (const Mesh& mesh : meshes_) {
    glDeleteVertexArrays(1, &mesh.vertexArray);
    glDeleteBuffers(1, &mesh.vertices);
    glDeleteBuffers(1, &mesh.indices);
  }
  glDeleteProgram(program_);
}

void BareLoop::draw() const {
  glUseProgram(program_);
  glUniformMatrix4fv(matrixLocation_, 1, GL_FALSE, matrix_);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glEnable(GL_CULL_FACE);
  glClearDepth(0.0);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  int drawn = 0;
  for (const Mesh& mesh : meshes_) {
    glBindVertexArray(mesh.vertexArray);
    glDrawElements(GL_TRIANGLES, mesh.indexCount, GL_UNSIGNED_SHORT, nullptr);
    if (++drawn % 8 == 0) glFlush();  // as the viewer does on software GL
  }
  glBindVertexArray(0);
}

}  // namespace terrane::bench

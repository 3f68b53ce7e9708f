#include "client/gl/objects.h"

#include <epoxy/gl.h>

namespace terrane::gl {
namespace {

GLenum glTarget(BufferTarget target) {
  switch (target) {
    case BufferTarget::Vertices:
      return GL_ARRAY_BUFFER;
    case BufferTarget::Indices:
      return GL_ELEMENT_ARRAY_BUFFER;
    case BufferTarget::Feedback:
      return GL_TRANSFORM_FEEDBACK_BUFFER;
  }
  return GL_ARRAY_BUFFER;
}

GLenum glUse(BufferUse use) {
  switch (use) {
    case BufferUse::Static:
      return GL_STATIC_DRAW;
    case BufferUse::Stream:
      return GL_STREAM_DRAW;
    case BufferUse::ReadBack:
      return GL_STREAM_READ;
  }
  return GL_STATIC_DRAW;
}

GLenum glType(Component type) {
  switch (type) {
    case Component::U8:
      return GL_UNSIGNED_BYTE;
    case Component::U16:
      return GL_UNSIGNED_SHORT;
    case Component::I16:
      return GL_SHORT;
    case Component::I32:
      return GL_INT;
    case Component::F32:
      return GL_FLOAT;
  }
  return GL_FLOAT;
}

}  // namespace

void deleteObject(ObjectKind kind, unsigned id) noexcept {
  switch (kind) {
    case ObjectKind::Buffer:
      glDeleteBuffers(1, &id);
      break;
    case ObjectKind::VertexArray:
      glDeleteVertexArrays(1, &id);
      break;
    case ObjectKind::Framebuffer:
      glDeleteFramebuffers(1, &id);
      break;
    case ObjectKind::Renderbuffer:
      glDeleteRenderbuffers(1, &id);
      break;
    case ObjectKind::Program:
      glDeleteProgram(id);
      break;
    case ObjectKind::Shader:
      glDeleteShader(id);
      break;
    case ObjectKind::Texture:
      glDeleteTextures(1, &id);
      break;
  }
}

Buffer::Buffer() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  handle_ = Handle<ObjectKind::Buffer>(id);
}

void Buffer::upload(BufferTarget target, std::span<const std::byte> data, BufferUse use) {
  bind(target);
  glBufferData(glTarget(target), static_cast<GLsizeiptr>(data.size()), data.data(), glUse(use));
  bytes_ = data.size();
}

void Buffer::allocate(BufferTarget target, std::size_t bytes, BufferUse use) {
  bind(target);
  glBufferData(glTarget(target), static_cast<GLsizeiptr>(bytes), nullptr, glUse(use));
  bytes_ = bytes;
}

void Buffer::read(std::size_t offset, std::span<std::byte> out) const {
  glBindBuffer(GL_COPY_READ_BUFFER, handle_.id());
  glGetBufferSubData(GL_COPY_READ_BUFFER, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(out.size()),
                     out.data());
}

void Buffer::bind(BufferTarget target) const { glBindBuffer(glTarget(target), handle_.id()); }

void Buffer::bindForFeedback() const { glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, handle_.id()); }

BufferWords::BufferWords(const Buffer& buffer) {
  GLuint id = 0;
  glGenTextures(1, &id);
  handle_ = Handle<ObjectKind::Texture>(id);
  bind();
  glTexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, buffer.handle_.id());
}

void BufferWords::bind() const {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_BUFFER, handle_.id());
}

VertexArray::VertexArray() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  handle_ = Handle<ObjectKind::VertexArray>(id);
}

void VertexArray::bind() const { glBindVertexArray(handle_.id()); }

void VertexArray::unbind() { glBindVertexArray(0); }

void VertexArray::attach(const Buffer& vertices, std::size_t stride, std::span<const VertexAttribute> attributes) {
  bind();
  vertices.bind(BufferTarget::Vertices);
  for (const VertexAttribute& attribute : attributes) {
    // GL takes offsets as pointers.
    const void* offset = reinterpret_cast<const void*>(attribute.offset);  // NOLINT(performance-no-int-to-ptr)
    const auto glStride = static_cast<GLsizei>(stride);
    glEnableVertexAttribArray(attribute.location);
    if (attribute.conversion == Conversion::Integer) {
      glVertexAttribIPointer(attribute.location, attribute.components, glType(attribute.type), glStride, offset);
    } else {
      const GLboolean normalized = attribute.conversion == Conversion::Normalized ? GL_TRUE : GL_FALSE;
      glVertexAttribPointer(attribute.location, attribute.components, glType(attribute.type), normalized, glStride,
                            offset);
    }
  }
}

void VertexArray::attachInstances(const Buffer& instances, std::size_t stride,
                                  std::span<const VertexAttribute> attributes) {
  attach(instances, stride, attributes);
  for (const VertexAttribute& attribute : attributes) glVertexAttribDivisor(attribute.location, 1);
}

void VertexArray::attachIndices(const Buffer& indices) {
  bind();
  indices.bind(BufferTarget::Indices);
}

}  // namespace terrane::gl

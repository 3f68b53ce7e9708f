#pragma once
// OpenGL objects as owning C++ values: move-only, freed with their owner, ids never leave this folder. GL thread only;
// a context must be current when one is made, used and destroyed (so everything that owns one goes before the Window
// does).

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace terrane::gl {

enum class ObjectKind : std::uint8_t { Buffer, VertexArray, Framebuffer, Renderbuffer, Program, Shader, Texture };

void deleteObject(ObjectKind kind, unsigned id) noexcept;

/// An owned GL name of one kind; 0 is none.
template <ObjectKind Kind>
class Handle {
 public:
  Handle() noexcept = default;
  explicit Handle(unsigned id) noexcept : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0u)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, 0u);
    }
    return *this;
  }
  ~Handle() { reset(); }

  unsigned id() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ != 0; }
  void reset() noexcept {
    if (id_ != 0) deleteObject(Kind, std::exchange(id_, 0u));
  }

 private:
  unsigned id_ = 0;
};

enum class BufferTarget : std::uint8_t { Vertices, Indices, Feedback };
enum class BufferUse : std::uint8_t { Static, Stream, ReadBack };

class Buffer {
 public:
  Buffer();
  /// Replaces the contents. Binding Indices changes the bound vertex array, as GL has it.
  void upload(BufferTarget target, std::span<const std::byte> data, BufferUse use);
  void allocate(BufferTarget target, std::size_t bytes, BufferUse use);
  void read(std::size_t offset, std::span<std::byte> out) const;
  void bind(BufferTarget target) const;
  /// As the one transform feedback buffer.
  void bindForFeedback() const;
  std::size_t bytes() const noexcept { return bytes_; }

 private:
  friend class BufferWords;
  Handle<ObjectKind::Buffer> handle_;
  std::size_t bytes_ = 0;
};

/// A buffer as shaders read it by index: 32-bit words, unsigned. Sees whatever the buffer then holds; the buffer must
/// outlive it.
class BufferWords {
 public:
  explicit BufferWords(const Buffer& buffer);
  /// As the one texture that programs sample.
  void bind() const;

 private:
  Handle<ObjectKind::Texture> handle_;
};

enum class Component : std::uint8_t { U8, U16, I16, I32, F32 };
enum class Conversion : std::uint8_t { Integer, Normalized, Float };

struct VertexAttribute {
  unsigned location = 0;
  int components = 0;
  Component type = Component::F32;
  Conversion conversion = Conversion::Float;
  std::size_t offset = 0;
};

class VertexArray {
 public:
  VertexArray();
  void bind() const;
  static void unbind();
  /// Attributes that come from one interleaved buffer. Leaves the array bound.
  void attach(const Buffer& vertices, std::size_t stride, std::span<const VertexAttribute> attributes);
  /// The same, one of each for an instance.
  void attachInstances(const Buffer& instances, std::size_t stride, std::span<const VertexAttribute> attributes);
  /// Leaves the array bound.
  void attachIndices(const Buffer& indices);

 private:
  Handle<ObjectKind::VertexArray> handle_;
};

template <class T>
std::span<const std::byte> bytesOf(const T& container) {
  return std::as_bytes(std::span(container));
}

}  // namespace terrane::gl

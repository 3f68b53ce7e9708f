#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <cmath>
#include <exception>
#include <new>
#include <optional>

#include "common/tiling/lattice.h"
#include "proto/draco_header.h"
#include "proto/draco_listener.h"

namespace terrane {
namespace {

Error malformed(const char* message) { return makeError(ErrorKind::Malformed, "draco", message); }
Error unsupported(const char* message) { return makeError(ErrorKind::Unsupported, "draco", message); }

/// What the stream must say of an attribute before its values are decoded.
struct AttributeForm {
  std::uint8_t type, dataType, components;
};
constexpr AttributeForm kPositionForm{draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3};
constexpr AttributeForm kNormalForm{draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3};
constexpr AttributeForm kColorForm{draco::GeometryAttribute::COLOR, draco::DT_UINT8, 3};
constexpr AttributeForm kGridForm{draco::GeometryAttribute::GENERIC, draco::DT_UINT16, 1};
constexpr std::uint32_t kMaxAttributes = 4;

/// Bytes that the decoder is about to read, looked at without taking them.
class Peek {
 public:
  explicit Peek(const draco::DecoderBuffer& buffer)
      : rest_(reinterpret_cast<const std::uint8_t*>(buffer.data_head()),
              static_cast<std::size_t>(buffer.remaining_size())) {}

  std::optional<std::uint8_t> byte() {
    if (rest_.empty()) return std::nullopt;
    const std::uint8_t value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  /// Of one byte only: no count or id in here needs more.
  std::optional<std::uint8_t> shortVarint() {
    const auto value = byte();
    return value && *value < 0x80 ? value : std::nullopt;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Draco's edgebreaker decoder, which looks at the attribute descriptors before they are acted on. Without this a few
/// bytes could ask for millions of attributes of 255 components each.
class GuardedDecoder : public draco::MeshEdgebreakerDecoder {
 public:
  explicit GuardedDecoder(const DracoAttributeIds& ids) : ids_(ids) {}
  const char* refusal() const noexcept { return refusal_; }
  /// Of the stream, from where the attributes' values begin; none if it did not come so far.
  std::optional<std::size_t> valueBytes() const noexcept { return valueBytes_; }

 protected:
  bool DecodeAllAttributes() override {
    valueBytes_ = static_cast<std::size_t>(buffer()->remaining_size());
    return draco::MeshEdgebreakerDecoder::DecodeAllAttributes();
  }
  bool DecodePointAttributes() override {
    refusal_ = checkDescriptors();
    return refusal_ == nullptr && draco::MeshEdgebreakerDecoder::DecodePointAttributes();
  }

 private:
  /// Null if they are what Terrane writes.
  const char* checkDescriptors() {
    Peek peek(*buffer());
    if (peek.byte() != 1) return "not one group of attributes";
    if (peek.byte() != 0xFF || peek.byte() != draco::MESH_VERTEX_ATTRIBUTE) return "attributes are not per vertex";
    if (const auto traversal = peek.byte(); !traversal || *traversal > 1) return "unknown traversal";
    const auto count = peek.shortVarint();
    if (!count || *count == 0 || *count > kMaxAttributes) return "too many attributes";
    std::uint32_t seen = 0;
    for (int i = 0; i < *count; ++i) {
      const auto type = peek.byte(), dataType = peek.byte(), components = peek.byte(), normalized = peek.byte();
      const auto id = peek.shortVarint();
      if (!normalized || !id) return "cut in its attributes";
      const AttributeForm* form = formOf(*id);
      if (form == nullptr || *id >= 32 || (seen & (1u << *id)) != 0) return "an attribute that was not announced";
      seen |= 1u << *id;
      if (type != form->type || dataType != form->dataType || components != form->components) {
        return "an attribute of another type";
      }
    }
    return nullptr;
  }

  const AttributeForm* formOf(int id) const {
    if (id == ids_.position) return &kPositionForm;
    if (id == ids_.normal) return &kNormalForm;
    if (id == ids_.color) return &kColorForm;
    if (id == ids_.grid) return &kGridForm;
    return nullptr;
  }

  DracoAttributeIds ids_;
  const char* refusal_ = nullptr;
  std::optional<std::size_t> valueBytes_;
};

/// The attribute's value for every point, in order. False if it is absent or smaller than the points say.
template <class T>
bool readAttribute(const draco::Mesh& mesh, int id, std::size_t components, std::vector<T>& values) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  if (attribute == nullptr || attribute->byte_stride() != static_cast<std::int64_t>(sizeof(T) * components))
    return false;
  if (attribute->buffer() == nullptr || attribute->byte_offset() != 0) return false;
  const std::uint64_t available = attribute->buffer()->data_size() / (sizeof(T) * components);
  values.resize(components * mesh.num_points());
  for (std::uint32_t point = 0; point < mesh.num_points(); ++point) {
    if (!attribute->is_mapping_identity() && point >= attribute->indices_map_size()) return false;
    const std::uint32_t index = attribute->mapped_index(draco::PointIndex(point)).value();
    if (index >= available) return false;
    attribute->buffer()->Read(static_cast<std::int64_t>(index * sizeof(T) * components), &values[components * point],
                              sizeof(T) * components);
  }
  return true;
}

Result<TileMesh> copyMesh(const draco::Mesh& mesh, const DracoAttributeIds& ids) {
  TileMesh out;
  std::vector<float> positions;
  if (!readAttribute(mesh, ids.position, 3, positions)) return malformed("no POSITION of three floats");
  if (!readAttribute(mesh, ids.normal, 3, out.normals)) return malformed("no NORMAL of three floats");
  if (ids.color >= 0 && !readAttribute(mesh, ids.color, 3, out.colors)) return malformed("no COLOR of three bytes");
  if (!readAttribute(mesh, ids.grid, 1, out.gridIndices)) return malformed("no grid index of 16 bits");

  out.offsets.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const float value = positions[i];
    // Written so that a NaN is refused.
    if (!(value >= 0.0f && value <= static_cast<float>(kTileOffsetMax))) return malformed("a position off the lattice");
    out.offsets[i] = static_cast<std::uint16_t>(value);
    if (static_cast<float>(out.offsets[i]) != value) return malformed("a position off the lattice");
  }
  for (std::size_t i = 0; i < out.normals.size(); i += 3) {
    const float x = out.normals[i], y = out.normals[i + 1], z = out.normals[i + 2];
    const float squared = x * x + y * y + z * z;
    if (!(squared > 0.99f && squared < 1.01f)) return malformed("a normal that is not of unit length");
  }
  out.triangles.reserve(3 * static_cast<std::size_t>(mesh.num_faces()));
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i))) {
      if (corner.value() >= mesh.num_points()) return malformed("a triangle of vertices that do not exist");
      out.triangles.push_back(corner.value());
    }
  }
  return out;
}

Result<TileMesh> decodeChecked(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                               const DracoHeader& header, const DracoListener& listener) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const draco::DecoderOptions options;
  GuardedDecoder decoder(ids);
  draco::Mesh mesh;
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  if (decoder.refusal() != nullptr) return malformed(decoder.refusal());
  if (!status.ok()) return makeError(ErrorKind::Malformed, "draco", status.error_msg_string());
  if (mesh.num_points() != header.vertexCount || mesh.num_faces() != header.triangleCount) {
    return malformed("other counts than its header says");
  }
  auto copied = copyMesh(mesh, ids);
  if (copied && listener) listener({decoder, mesh, bytes.first(bytes.size() - *decoder.valueBytes())}, *copied);
  return copied;
}

}  // namespace

Result<DracoHeader> checkDracoStream(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                                     const DecodeLimits& limits) {
  if (ids.position < 0 || ids.normal < 0 || ids.grid < 0) return malformed("POSITION, NORMAL and _GRID are needed");
  if (bytes.size() > limits.maxBytes) return makeError(ErrorKind::TooLarge, "draco", "more bytes than the limit");
  const auto header = readDracoHeader(bytes);
  if (!header) return header.error();
  if (header->vertexCount > limits.maxVertices)
    return makeError(ErrorKind::TooLarge, "draco", "more vertices than the limit");
  if (header->triangleCount > limits.maxTriangles)
    return makeError(ErrorKind::TooLarge, "draco", "more triangles than the limit");
  if (bytes.size() > kMaxDracoBytesBesides + kMaxDracoBytesPerVertex * header->vertexCount) {
    return malformed("more bytes than its vertices can need");
  }
  if (header->attributeConnectivities != 0) return unsupported("attributes with seams are not read");
  return *header;
}

Result<TileMesh> decodeDraco(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const DecodeLimits& limits, const DracoListener& listener) {
  const auto header = checkDracoStream(bytes, ids, limits);
  if (!header) return header.error();
  try {
    return decodeChecked(bytes, ids, *header, listener);
  } catch (const std::bad_alloc&) {
    return makeError(ErrorKind::TooLarge, "draco", "asks for more memory than there is");
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Malformed, "draco", e.what());
  }
}

Result<TileMesh> decodeDraco(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const DecodeLimits& limits) {
  return decodeDraco(bytes, ids, limits, {});
}

void decodeDracoConnectivity(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const std::function<void(const DracoDecoded&)>& listener) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const draco::DecoderOptions options;
  GuardedDecoder decoder(ids);
  draco::Mesh mesh;
  (void)decoder.Decode(options, &buffer, &mesh);
  if (decoder.valueBytes()) listener({decoder, mesh, bytes.first(bytes.size() - *decoder.valueBytes())});
}

}  // namespace terrane

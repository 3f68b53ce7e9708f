#include "proto/draco_input.h"

#include <draco/compression/expert_encode.h>
#include <draco/compression/mesh/mesh_edgebreaker_encoder.h>

#include <algorithm>
#include <array>
#include <string>

#include "common/numerics/strict_math.h"

namespace terrane {
namespace {

constexpr int kPositionBits = 16;
constexpr float kPositionRange = 65535.0f;

Error invalid(const char* field, std::string message) {
  return makeError(ErrorKind::InvalidArgument, field, std::move(message));
}

/// An attribute whose value i belongs to point i. Returns its id.
int addAttribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType dataType, int components,
                 bool normalized, const void* values, std::size_t byteCount) {
  draco::GeometryAttribute description;
  const auto stride = static_cast<std::int64_t>(byteCount / mesh.num_points());
  description.Init(type, nullptr, static_cast<std::int8_t>(components), dataType, normalized, stride, 0);
  const int id = mesh.AddAttribute(description, true, mesh.num_points());
  mesh.attribute(id)->buffer()->Write(0, values, byteCount);
  return id;
}

}  // namespace

Result<void> checkDracoSettings(const DracoSettings& settings) {
  if (settings.speed < 0 || settings.speed > 10) return invalid("speed", "0 to 10");
  if (settings.normalBits < 2 || settings.normalBits > 16) return invalid("normalBits", "2 to 16");
  return {};
}

Result<void> checkDracoMesh(const TileMesh& mesh) {
  const std::size_t vertices = mesh.vertexCount();
  if (vertices < 3 || vertices > 0x7FFFFFFFu / 3) return invalid("gridIndices", "a mesh has at least three vertices");
  if (mesh.offsets.size() != 3 * vertices) return invalid("offsets", "not three a vertex");
  if (mesh.normals.size() != 3 * vertices) return invalid("normals", "not three a vertex");
  if (!mesh.colors.empty() && mesh.colors.size() != 3 * vertices) return invalid("colors", "not three a vertex");
  if (mesh.triangles.empty() || mesh.triangles.size() % 3 != 0)
    return invalid("triangles", "not three indices a triangle");
  const std::uint32_t last = *std::max_element(mesh.triangles.begin(), mesh.triangles.end());
  if (last >= vertices) return invalid("triangles", "index out of range");
  for (std::size_t i = 0; i < mesh.normals.size(); i += 3) {
    const float x = mesh.normals[i], y = mesh.normals[i + 1], z = mesh.normals[i + 2];
    const float squared = x * x + y * y + z * z;
    // Written so that a NaN is refused; the lower bound keeps the encoder's own normalisation finite.
    if (!(squared > 1e-12f && squared < 1e12f)) return invalid("normals", "zero, not finite, or far from unit length");
  }
  return {};
}

DracoInput::DracoInput(const TileMesh& mesh) : mesh_(std::make_unique<draco::Mesh>()) {
  draco::Mesh& input = *mesh_;
  input.set_num_points(static_cast<std::uint32_t>(mesh.vertexCount()));
  input.SetNumFaces(mesh.triangles.size() / 3);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    input.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(i / 3)),
                  {draco::PointIndex(mesh.triangles[i]), draco::PointIndex(mesh.triangles[i + 1]),
                   draco::PointIndex(mesh.triangles[i + 2])});
  }
  const std::vector<float> positions(mesh.offsets.begin(), mesh.offsets.end());
  using Attribute = draco::GeometryAttribute;
  ids_.positionId =
      addAttribute(input, Attribute::POSITION, draco::DT_FLOAT32, 3, false, positions.data(), 4 * positions.size());
  ids_.normalId =
      addAttribute(input, Attribute::NORMAL, draco::DT_FLOAT32, 3, false, mesh.normals.data(), 4 * mesh.normals.size());
  if (!mesh.colors.empty()) {
    ids_.colorId =
        addAttribute(input, Attribute::COLOR, draco::DT_UINT8, 3, true, mesh.colors.data(), mesh.colors.size());
  }
  ids_.gridId = addAttribute(input, Attribute::GENERIC, draco::DT_UINT16, 1, false, mesh.gridIndices.data(),
                             2 * mesh.gridIndices.size());
}

DracoInput::~DracoInput() = default;

Result<void> DracoInput::encode(draco::MeshEdgebreakerEncoder& encoder, const DracoSettings& settings,
                                draco::EncoderBuffer& out) const {
  draco::ExpertEncoder expert(*mesh_);
  expert.SetSpeedOptions(settings.speed, settings.speed);
  expert.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  // One connectivity for all attributes: no seams are looked for, and points stay what they are.
  expert.options().SetGlobalBool("split_mesh_on_seams", true);
  const std::array<float, 3> origin{};
  expert.SetAttributeExplicitQuantization(ids_.positionId, kPositionBits, 3, origin.data(), kPositionRange);
  expert.SetAttributeQuantization(ids_.normalId, settings.normalBits);
  encoder.SetMesh(*mesh_);
  const draco::Status status = encoder.Encode(expert.options(), &out);
  if (!status.ok()) return makeError(ErrorKind::Internal, "draco", status.error_msg_string());
  return {};
}

}  // namespace terrane

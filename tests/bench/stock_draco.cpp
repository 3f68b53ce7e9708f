#include "tests/bench/stock_draco.h"

#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <memory>

#include "tests/bench/measure.h"

namespace terrane::bench {
namespace {

template <class T>
int addAttribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType dataType, int components,
                 bool normalized, const T* values) {
  const auto count = mesh.num_points();
  draco::GeometryAttribute description;
  description.Init(type, nullptr, static_cast<std::int8_t>(components), dataType, normalized,
                   static_cast<std::int64_t>(sizeof(T)) * components, 0);
  const int id = mesh.AddAttribute(description, true, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                          values + static_cast<std::size_t>(i) * components);
  }
  return id;
}

}  // namespace

StockEncode encodeWithStockDraco(const TileMesh& mesh, const DracoSettings& settings, bool deduplicate) {
  const double start = threadMs();
  draco::Mesh output;
  output.set_num_points(static_cast<std::uint32_t>(mesh.vertexCount()));
  output.SetNumFaces(mesh.triangles.size() / 3);
  for (std::uint32_t face = 0; face < mesh.triangles.size() / 3; ++face) {
    output.SetFace(draco::FaceIndex(face),
                   {draco::PointIndex(mesh.triangles[3 * face]), draco::PointIndex(mesh.triangles[3 * face + 1]),
                    draco::PointIndex(mesh.triangles[3 * face + 2])});
  }
  std::vector<float> positions(mesh.offsets.begin(), mesh.offsets.end());
  addAttribute(output, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, false, positions.data());
  addAttribute(output, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3, false, mesh.normals.data());
  if (!mesh.colors.empty()) {
    addAttribute(output, draco::GeometryAttribute::COLOR, draco::DT_UINT8, 3, true, mesh.colors.data());
  }
  addAttribute(output, draco::GeometryAttribute::GENERIC, draco::DT_UINT16, 1, false, mesh.gridIndices.data());
  if (deduplicate) {
    output.DeduplicateAttributeValues();
    output.DeduplicatePointIds();
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(settings.speed, settings.speed);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, settings.normalBits);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(output, &buffer).ok()) return {};
  return {threadMs() - start, buffer.size()};
}

}  // namespace terrane::bench

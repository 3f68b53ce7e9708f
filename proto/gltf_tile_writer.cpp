#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>

#include "common/numerics/strict_math.h"
#include "proto/glb_container.h"
#include "proto/gltf_tile.h"

namespace terrane {
namespace {

constexpr int kByte = 5121, kShort = 5123, kInt = 5125, kFloat = 5126;  // glTF component types, the integers unsigned

/// Appends JSON. The document has one form, so it is written as text around its numbers: a JSON library took longer
/// than all the rest of the container, and its number formats are its own.
class JsonText {
 public:
  explicit JsonText(std::size_t expectedBytes) { text_.reserve(expectedBytes); }

  JsonText& raw(std::string_view text) {
    text_ += text;
    return *this;
  }
  JsonText& number(std::integral auto value) { return convert(value); }
  /// Shortest decimals that read back as the same value. Precondition: finite.
  JsonText& number(std::floating_point auto value) { return convert(value == 0 ? decltype(value){0} : value); }

  template <class Values>
  JsonText& list(const Values& values) {
    char separator = '[';
    for (const auto& value : values) {
      text_ += separator;
      number(value);
      separator = ',';
    }
    text_ += ']';
    return *this;
  }
  JsonText& list(const glm::dvec3& v) { return list(std::array{v.x, v.y, v.z}); }

  std::string take() && { return std::move(text_); }

 private:
  JsonText& convert(auto value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text_.append(digits.data(), end);
    return *this;
  }

  std::string text_;
};

bool allFinite(const TileMetadata& m) {
  const std::array values{m.heights.minMeters,        m.heights.maxMeters,
                          m.subtreeHeights.minMeters, m.subtreeHeights.maxMeters,
                          m.geometricErrorMeters,     m.sphere.center.x,
                          m.sphere.center.y,          m.sphere.center.z,
                          m.sphere.radiusMeters,      static_cast<double>(m.skirtMeters)};
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void writeAccessors(JsonText& json, const TileMesh& mesh, const DracoBuffer& draco) {
  std::array<std::uint16_t, 3> low{0xFFFF, 0xFFFF, 0xFFFF}, high{0, 0, 0};
  for (std::size_t i = 0; i < mesh.offsets.size(); i += 3) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], mesh.offsets[i + axis]);
      high[axis] = std::max(high[axis], mesh.offsets[i + axis]);
    }
  }
  const auto accessor = [&](std::uint32_t count, int component, std::string_view rest) {
    json.raw("{\"componentType\":").number(component).raw(",\"count\":").number(count).raw(rest);
  };
  json.raw("\"accessors\":[");
  // The highest 16-bit index is primitive restart's.
  accessor(3 * draco.triangleCount, draco.vertexCount <= 0xFFFF ? kShort : kInt, ",\"type\":\"SCALAR\"},");
  accessor(draco.vertexCount, kFloat, ",\"type\":\"VEC3\",\"min\":");
  json.list(low).raw(",\"max\":").list(high).raw("},");
  accessor(draco.vertexCount, kFloat, ",\"type\":\"VEC3\"},");
  accessor(draco.vertexCount, kShort, ",\"type\":\"SCALAR\"}");
  if (draco.colorId >= 0) {
    json.raw(",");
    accessor(draco.vertexCount, kByte, ",\"type\":\"VEC3\",\"normalized\":true}");
  }
  json.raw("],");
}

void writeMesh(JsonText& json, const DracoBuffer& draco) {
  json.raw("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":1,\"NORMAL\":2,\"_GRID\":3");
  if (draco.colorId >= 0) json.raw(",\"COLOR_0\":4");
  json.raw(
      "},\"indices\":0,\"material\":0,\"mode\":4,\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,");
  json.raw("\"attributes\":{\"POSITION\":").number(draco.positionId).raw(",\"NORMAL\":").number(draco.normalId);
  json.raw(",\"_GRID\":").number(draco.gridId);
  if (draco.colorId >= 0) json.raw(",\"COLOR_0\":").number(draco.colorId);
  json.raw("}}}}]}],");
}

void writeNode(JsonText& json, const TileMetadata& m) {
  const double step = stepMeters(m.stepExponent);
  const glm::dvec3 origin = latticePosition(m.origin, m.stepExponent);
  json.raw("\"nodes\":[{\"mesh\":0,\"matrix\":");
  json.list(
      std::array{step, 0.0, 0.0, 0.0, 0.0, 0.0, -step, 0.0, 0.0, step, 0.0, 0.0, origin.x, origin.z, -origin.y, 1.0});
  json.raw(",\"extras\":{\"terrane\":{\"path\":\"").raw(m.path.text());
  json.raw("\",\"level\":").number(m.path.level());
  json.raw(",\"stepExponent\":").number(m.stepExponent).raw(",\"step\":").number(step);
  json.raw(",\"origin\":").list(std::array{m.origin.x, m.origin.y, m.origin.z});
  json.raw(",\"heights\":").list(std::array{m.heights.minMeters, m.heights.maxMeters});
  json.raw(",\"subtreeHeights\":").list(std::array{m.subtreeHeights.minMeters, m.subtreeHeights.maxMeters});
  json.raw(",\"geometricError\":").number(m.geometricErrorMeters);
  json.raw(",\"sphere\":")
      .list(std::array{m.sphere.center.x, m.sphere.center.y, m.sphere.center.z, m.sphere.radiusMeters});
  json.raw(",\"horizonPoint\":");
  isFinite(m.horizonPoint) ? json.list(m.horizonPoint) : json.raw("null");
  json.raw(",\"cellsPerEdge\":").number(m.cellsPerEdge);
  json.raw(",\"skirt\":").number(m.skirtMeters).raw("}}}],");
}

std::string writeDocument(const TileMetadata& metadata, const TileMesh& mesh, const DracoBuffer& draco) {
  constexpr std::size_t kTypicalBytes = 2048;
  JsonText json(kTypicalBytes);
  json.raw(R"({"asset":{"version":"2.0","generator":"Terrane"},)");
  json.raw(R"("extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"],)");
  json.raw(R"("scene":0,"scenes":[{"nodes":[0]}],)");
  writeNode(json, metadata);
  writeMesh(json, draco);
  // COLOR_0 times the factor is the linear reflectance.
  json.raw(R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":)");
  json.list(std::array{kColorScale, kColorScale, kColorScale, 1.0f});
  json.raw(R"(,"metallicFactor":0,"roughnessFactor":1}}],)");
  writeAccessors(json, mesh, draco);
  json.raw(R"("bufferViews":[{"buffer":0,"byteLength":)").number(draco.bytes.size());
  json.raw(R"(}],"buffers":[{"byteLength":)").number(draco.bytes.size()).raw("}]}");
  return std::move(json).take();
}

}  // namespace

Result<std::vector<std::uint8_t>> writeTileGlb(const TileMetadata& metadata, const TileMesh& mesh,
                                               const DracoBuffer& draco) {
  if (!allFinite(metadata)) return makeError(ErrorKind::InvalidArgument, "metadata", "a number that is not finite");
  if (mesh.vertexCount() != draco.vertexCount || mesh.offsets.size() != 3 * mesh.vertexCount()) {
    return makeError(ErrorKind::InvalidArgument, "draco", "encodes another mesh");
  }
  return packGlb(writeDocument(metadata, mesh, draco), draco.bytes);
}

Result<std::vector<std::uint8_t>> encodeTile(const Tile& tile, const DracoSettings& settings) {
  const auto draco = encodeDraco(tile.mesh, settings);
  if (!draco) return draco.error();
  return writeTileGlb(tile.metadata, tile.mesh, *draco);
}

}  // namespace terrane

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "proto/draco_reader.h"
#include "proto/glb_container.h"
#include "proto/gltf_tile.h"
#include "proto/json_cursor.h"

namespace terrane {
namespace {

constexpr JsonDocument::Limits kJsonLimits{.maxBytes = 64u << 10, .maxDepth = 16};
constexpr double kMaxMeters = 1e12;
constexpr std::int64_t kMaxOrigin = std::int64_t{1} << 52;
constexpr int kMinReadStepExponent = -60, kMaxReadStepExponent = 60;
constexpr std::int64_t kMaxAttributeId = 31;
constexpr std::size_t kMaxGridIndices = 65536;

glm::dvec3 readVector(const JsonCursor& at) {
  at.arraySize(3, 3);
  const auto component = [&](std::size_t i) { return at.element(i).number(-kMaxMeters, kMaxMeters); };
  return {component(0), component(1), component(2)};
}

HeightRange readHeights(const JsonCursor& at) {
  at.arraySize(2, 2);
  const HeightRange heights{at.element(0).number(-kMaxMeters, kMaxMeters),
                            at.element(1).number(-kMaxMeters, kMaxMeters)};
  if (heights.minMeters > heights.maxMeters) at.fail("the lowest is above the highest");
  return heights;
}

std::size_t vertexLimit(Scheme scheme, int cellsPerEdge) {
  return gridVertexCount(scheme, cellsPerEdge) + skirtVertexCount(scheme, cellsPerEdge);
}

FacePath readPath(const JsonCursor& extras) {
  constexpr std::size_t kMaxPathBytes = 64;
  const JsonCursor at = extras.member("path");
  const auto path = FacePath::parse(at.text(kMaxPathBytes));
  if (!path) {
    at.fail(path.error().text());
    return {};
  }
  if (extras.member("level").integer(0, FacePath::kMaxLevel) != path->level())
    extras.member("level").fail("not the path's");
  return *path;
}

TileMetadata readMetadata(const JsonCursor& extras) {
  TileMetadata m;
  m.path = readPath(extras);
  m.stepExponent = static_cast<int>(extras.member("stepExponent").integer(kMinReadStepExponent, kMaxReadStepExponent));
  if (extras.member("step").number(0, kMaxMeters * kMaxMeters) != stepMeters(m.stepExponent)) {
    extras.member("step").fail("not 2^stepExponent");
  }
  const JsonCursor origin = extras.member("origin");
  origin.arraySize(3, 3);
  for (int axis = 0; axis < 3; ++axis) {
    m.origin[axis] = origin.element(static_cast<std::size_t>(axis)).integer(-kMaxOrigin, kMaxOrigin);
  }
  m.heights = readHeights(extras.member("heights"));
  const JsonCursor subtree = extras.member("subtreeHeights");
  m.subtreeHeights = readHeights(subtree);
  if (m.subtreeHeights.minMeters > m.heights.minMeters || m.subtreeHeights.maxMeters < m.heights.maxMeters) {
    subtree.fail("does not hold the tile's own heights");
  }
  m.geometricErrorMeters = extras.member("geometricError").number(0, kMaxMeters);
  const JsonCursor sphere = extras.member("sphere");
  sphere.arraySize(4, 4);
  for (int axis = 0; axis < 3; ++axis) {
    m.sphere.center[axis] = sphere.element(static_cast<std::size_t>(axis)).number(-kMaxMeters, kMaxMeters);
  }
  m.sphere.radiusMeters = sphere.element(3).number(0, kMaxMeters);
  const auto horizon = extras.optionalMember("horizonPoint");
  m.horizonPoint = horizon ? readVector(*horizon) : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  const JsonCursor cells = extras.member("cellsPerEdge");
  m.cellsPerEdge = static_cast<int>(cells.integer(1, 1024));
  if (vertexLimit(m.path.scheme(), m.cellsPerEdge) > kMaxGridIndices)
    cells.fail("more than 16-bit grid indices number");
  m.skirtMeters = static_cast<float>(extras.member("skirt").number(0, kMaxMeters));
  return m;
}

/// The node's matrix must say what the metadata says: one of the two would place the tile wrongly otherwise.
void checkMatrix(const JsonCursor& node, const TileMetadata& m) {
  const double s = stepMeters(m.stepExponent);
  const glm::dvec3 origin = latticePosition(m.origin, m.stepExponent);
  const std::array<double, 16> expected{s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, origin.x, origin.z, -origin.y, 1};
  const JsonCursor matrix = node.member("matrix");
  matrix.arraySize(16, 16);
  constexpr double kAny = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const JsonCursor element = matrix.element(i);
    if (element.number(-kAny, kAny) != expected[i]) element.fail("contradicts extras.terrane");
  }
}

/// What the glTF document says of the one primitive.
struct Primitive {
  DracoAttributeIds ids;
  std::size_t dracoOffset = 0, dracoBytes = 0;
  std::int64_t vertexCount = 0, indexCount = 0;
};

int attributeId(const JsonCursor& attributes, std::string_view name) {
  return static_cast<int>(attributes.member(name).integer(0, kMaxAttributeId));
}

/// The count of the accessor that the member names.
std::int64_t accessorCount(const JsonCursor& document, const JsonCursor& reference) {
  constexpr std::int64_t kMaxIndex = 1 << 20;
  const JsonCursor accessors = document.member("accessors");
  return accessors.element(static_cast<std::size_t>(reference.integer(0, kMaxIndex)))
      .member("count")
      .integer(1, UINT32_MAX);
}

void readBufferView(const JsonCursor& document, const JsonCursor& reference, std::size_t binBytes,
                    Primitive& primitive) {
  document.member("buffers").arraySize(1, 1);
  const JsonCursor buffer = document.member("buffers").element(0);
  if (const auto uri = buffer.optionalMember("uri"))
    uri->fail("only the GLB's own buffer is read", ErrorKind::Unsupported);
  const auto most = static_cast<std::int64_t>(binBytes);
  const std::int64_t bufferBytes = buffer.member("byteLength").integer(1, most);
  const JsonCursor view =
      document.member("bufferViews").element(static_cast<std::size_t>(reference.integer(0, 1 << 20)));
  view.member("buffer").integer(0, 0);
  const auto offset = view.optionalMember("byteOffset");
  const std::int64_t offsetBytes = offset ? offset->integer(0, bufferBytes) : 0;
  primitive.dracoOffset = static_cast<std::size_t>(offsetBytes);
  primitive.dracoBytes = static_cast<std::size_t>(view.member("byteLength").integer(0, bufferBytes - offsetBytes));
}

Primitive readPrimitive(const JsonCursor& document, const JsonCursor& node, std::size_t binBytes) {
  Primitive result;
  const JsonCursor mesh =
      document.member("meshes").element(static_cast<std::size_t>(node.member("mesh").integer(0, 1 << 20)));
  mesh.member("primitives").arraySize(1, 1);
  const JsonCursor primitive = mesh.member("primitives").element(0);
  if (const auto mode = primitive.optionalMember("mode")) mode->integer(4, 4);
  const JsonCursor draco = primitive.member("extensions").member("KHR_draco_mesh_compression");
  const JsonCursor attributes = draco.member("attributes");
  result.ids.position = attributeId(attributes, "POSITION");
  result.ids.normal = attributeId(attributes, "NORMAL");
  result.ids.grid = attributeId(attributes, "_GRID");
  if (const auto color = attributes.optionalMember("COLOR_0")) {
    result.ids.color = static_cast<int>(color->integer(0, kMaxAttributeId));
  }
  result.vertexCount = accessorCount(document, primitive.member("attributes").member("POSITION"));
  result.indexCount = accessorCount(document, primitive.member("indices"));
  readBufferView(document, draco.member("bufferView"), binBytes, result);
  return result;
}

/// reader may be null.
Result<Tile> decodeChunks(const GlbChunks& chunks, DracoReader* reader, const DecodeLimits& limits) {
  auto document = JsonDocument::parse(chunks.json, kJsonLimits, "json");
  if (!document) return document.error();
  const JsonCursor json = document->root("json");
  if (json.member("asset").member("version").text(16) != "2.0") {
    json.member("asset").member("version").fail("only glTF 2.0 is read", ErrorKind::Unsupported);
  }
  const JsonCursor scene =
      json.member("scenes").element(static_cast<std::size_t>(json.member("scene").integer(0, 1 << 20)));
  const JsonCursor roots = scene.member("nodes");
  roots.arraySize(1, 1);
  const JsonCursor node = json.member("nodes").element(static_cast<std::size_t>(roots.element(0).integer(0, 1 << 20)));

  Tile tile;
  JsonCursor extras = node.member("extras").member("terrane");
  extras.rename("extras.terrane");
  tile.metadata = readMetadata(extras);
  if (json.ok()) checkMatrix(node, tile.metadata);
  const Primitive primitive = readPrimitive(json, node, chunks.bin.size());
  if (document->error()) return *document->error();

  const auto draco = chunks.bin.subspan(primitive.dracoOffset, primitive.dracoBytes);
  auto mesh =
      reader != nullptr ? reader->decode(draco, primitive.ids, limits) : decodeDraco(draco, primitive.ids, limits);
  if (!mesh) return mesh.error();
  const auto refuse = [](const char* message) { return makeError(ErrorKind::Malformed, "draco", message); };
  if (static_cast<std::int64_t>(mesh->vertexCount()) != primitive.vertexCount)
    return refuse("other vertices than the accessor");
  if (static_cast<std::int64_t>(mesh->triangles.size()) != primitive.indexCount)
    return refuse("other indices than the accessor");
  const std::size_t gridLimit = vertexLimit(tile.metadata.path.scheme(), tile.metadata.cellsPerEdge);
  for (const std::uint16_t index : mesh->gridIndices) {
    if (index >= gridLimit) return refuse("a grid index beyond the grid");
  }
  tile.mesh = std::move(*mesh);
  return tile;
}

Result<Tile> decodeGlb(std::span<const std::uint8_t> glb, DracoReader* reader, const DecodeLimits& limits) {
  if (glb.size() > limits.maxBytes) return makeError(ErrorKind::TooLarge, "header", "more bytes than the limit");
  const auto chunks = unpackGlb(glb);
  if (!chunks) return chunks.error();
  try {
    return decodeChunks(*chunks, reader, limits);
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Malformed, "json", e.what());
  }
}

}  // namespace

Result<Tile> decodeTile(std::span<const std::uint8_t> glb, const DecodeLimits& limits) {
  return decodeGlb(glb, nullptr, limits);
}

Result<Tile> decodeTile(std::span<const std::uint8_t> glb, DracoReader& reader, const DecodeLimits& limits) {
  return decodeGlb(glb, &reader, limits);
}

}  // namespace terrane

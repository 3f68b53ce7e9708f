#include "client/render/gpu_tiles.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

namespace terrane {
namespace {

/// Reflectance byte of a body of one colour.
constexpr std::uint8_t kPlainColor = 96;

/// From a byte of the wire (linear) to one of the GPU (the display's curve).
std::array<std::uint8_t, 256> makeDisplayBytes() {
  std::array<std::uint8_t, 256> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(std::lround(255 * std::pow(static_cast<double>(i) / 255, 1 / kDisplayGamma)));
  return bytes;
}

/// Cells on a side of the blocks in which triangles are drawn: 14 x 14 vertices then fit the 256 entries of the vertex
/// cache of software GL (and any GPU's), so that few vertices are shaded twice. In Draco's order of decoding many are.
constexpr int kBlockCells = 13;

constexpr unsigned kPositionLocation = 0, kNormalLocation = 1, kColorLocation = 2, kRelativeLocation = 3;
using gl::Component, gl::Conversion;
constexpr std::array kAttributes{
    gl::VertexAttribute{kPositionLocation, 4, Component::U16, Conversion::Integer, offsetof(GpuVertex, offset)},
    gl::VertexAttribute{kNormalLocation, 4, Component::I16, Conversion::Normalized, offsetof(GpuVertex, normal)},
    gl::VertexAttribute{kColorLocation, 4, Component::U8, Conversion::Normalized, offsetof(GpuVertex, color)},
};
constexpr std::array kRelativeAttributes{
    gl::VertexAttribute{kRelativeLocation, 3, Component::F32, Conversion::Float, 0},
};

int surfaceVertexCount(const TileMetadata& metadata) {
  return (metadata.cellsPerEdge + 1) * (metadata.cellsPerEdge + 1);
}

std::vector<GpuVertex> packVertices(const Tile& tile) {
  const TileMesh& mesh = tile.mesh;
  const int surface = surfaceVertexCount(tile.metadata);
  static const std::array<std::uint8_t, 256> displayBytes = makeDisplayBytes();
  std::vector<GpuVertex> vertices(mesh.vertexCount());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    GpuVertex& vertex = vertices[i];
    for (std::size_t c = 0; c < 3; ++c) {
      vertex.offset[c] = mesh.offsets[3 * i + c];
      const float normal = std::clamp(mesh.normals[3 * i + c], -1.0f, 1.0f);
      vertex.normal[c] = static_cast<std::int16_t>(std::lround(normal * 32767.0f));
      vertex.color[c] = displayBytes[mesh.colors.empty() ? kPlainColor : mesh.colors[3 * i + c]];
    }
    vertex.skirt = mesh.gridIndices[i] >= surface ? 1 : 0;
  }
  return vertices;
}

struct OrderedTriangles {
  std::vector<std::uint32_t> indices;
  std::size_t surfaceIndices = 0;
};

/// Surface triangles block by block, then the skirts in the order they came.
OrderedTriangles orderTriangles(const Tile& tile) {
  const TileMesh& mesh = tile.mesh;
  const int row = tile.metadata.cellsPerEdge + 1, surface = surfaceVertexCount(tile.metadata);
  const int blocksPerRow = tile.metadata.cellsPerEdge / kBlockCells + 1;
  struct Keyed {
    int key;  ///< block, or one past all blocks for a skirt
    std::size_t triangle;
  };
  std::vector<Keyed> order(mesh.triangles.size() / 3);
  OrderedTriangles result;
  for (std::size_t t = 0; t < order.size(); ++t) {
    int column = row, line = row;  // the triangle's cell: its lowest corner
    bool skirt = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const int grid = mesh.gridIndices[mesh.triangles[3 * t + c]];
      skirt |= grid >= surface;
      column = std::min(column, grid % row);
      line = std::min(line, grid / row);
    }
    const int block = line / kBlockCells * blocksPerRow + column / kBlockCells;
    order[t] = {skirt ? blocksPerRow * blocksPerRow : block, t};
    if (!skirt) result.surfaceIndices += 3;
  }
  std::ranges::stable_sort(order, {}, &Keyed::key);
  result.indices.reserve(mesh.triangles.size());
  for (const Keyed& keyed : order)
    for (std::size_t c = 0; c < 3; ++c) result.indices.push_back(mesh.triangles[3 * keyed.triangle + c]);
  return result;
}

}  // namespace

void GpuTile::placeOnCpu(const glm::dvec3& cameraBody, std::vector<float>& scratch) {
  if (!relativeArray) {
    std::vector<GpuVertex> held(vertexCount);
    vertices.read(0, std::as_writable_bytes(std::span(held)));
    offsets.resize(3 * vertexCount);
    for (std::size_t i = 0; i < vertexCount; ++i)
      std::ranges::copy(held[i].offset, offsets.begin() + static_cast<std::ptrdiff_t>(3 * i));
    relativePositions = std::make_unique<gl::Buffer>();
    relativeArray = std::make_unique<gl::VertexArray>();
    relativeArray->attach(vertices, sizeof(GpuVertex), std::span(kAttributes).subspan(1));
    relativeArray->attach(*relativePositions, 3 * sizeof(float), kRelativeAttributes);
    relativeArray->attachIndices(indices->buffer);
  }
  const double step = stepMeters(metadata.stepExponent);
  const LatticePoint& origin = metadata.origin;
  scratch.resize(offsets.size());
  for (std::size_t i = 0; i < scratch.size(); i += 3) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t at = i + static_cast<std::size_t>(axis);
      const auto steps = static_cast<double>(origin[axis] + offsets[at]);
      scratch[at] = static_cast<float>(steps * step - cameraBody[axis]);
    }
  }
  relativeArray->bind();
  relativePositions->upload(gl::BufferTarget::Vertices, gl::bytesOf(scratch), gl::BufferUse::Stream);
}

std::shared_ptr<const SharedIndices> GpuTiles::indicesFor(const Tile& tile, std::size_t& bytesTaken) {
  const TileMesh& mesh = tile.mesh;
  // The order depends on the grid indices too, so both make the fingerprint.
  const XXH128_hash_t grid = XXH3_128bits(mesh.gridIndices.data(), mesh.gridIndices.size() * sizeof(std::uint16_t));
  const XXH128_hash_t hash = XXH3_128bits_withSeed(mesh.triangles.data(), mesh.triangles.size() * sizeof(std::uint32_t),
                                                   grid.low64 ^ static_cast<std::uint64_t>(tile.metadata.cellsPerEdge));
  std::weak_ptr<const SharedIndices>& slot = shared_[{hash.low64 ^ grid.high64, hash.high64}];
  if (auto held = slot.lock()) return held;

  const OrderedTriangles ordered = orderTriangles(tile);
  auto made = std::make_shared<SharedIndices>();
  made->surfaceIndices = ordered.surfaceIndices;
  made->skirtIndices = ordered.indices.size() - ordered.surfaceIndices;
  made->wide = mesh.vertexCount() > 65536;
  gl::VertexArray::unbind();
  if (made->wide) {
    made->buffer.upload(gl::BufferTarget::Indices, gl::bytesOf(ordered.indices), gl::BufferUse::Static);
  } else {
    const std::vector<std::uint16_t> narrow(ordered.indices.begin(), ordered.indices.end());
    made->buffer.upload(gl::BufferTarget::Indices, gl::bytesOf(narrow), gl::BufferUse::Static);
  }
  bytesTaken += made->buffer.bytes();
  slot = made;
  return made;
}

std::size_t GpuTiles::upload(const Tile& tile) {
  remove(tile.metadata.path);
  auto uploaded = std::make_unique<GpuTile>();
  std::size_t bytesTaken = 0;
  uploaded->metadata = tile.metadata;
  uploaded->vertexCount = tile.mesh.vertexCount();
  uploaded->indices = indicesFor(tile, bytesTaken);
  uploaded->vertices.upload(gl::BufferTarget::Vertices, gl::bytesOf(packVertices(tile)), gl::BufferUse::Static);
  uploaded->array.attach(uploaded->vertices, sizeof(GpuVertex), kAttributes);
  uploaded->array.attachIndices(uploaded->indices->buffer);
  gl::VertexArray::unbind();
  vertexBytes_ += uploaded->vertices.bytes();
  bytesTaken += uploaded->vertices.bytes();
  tiles_[tile.metadata.path] = std::move(uploaded);
  return bytesTaken;
}

void GpuTiles::remove(const FacePath& path) {
  const auto found = tiles_.find(path);
  if (found == tiles_.end()) return;
  vertexBytes_ -= found->second->vertices.bytes();
  tiles_.erase(found);
  std::erase_if(shared_, [](const auto& entry) { return entry.second.expired(); });
}

void GpuTiles::clear() {
  tiles_.clear();
  shared_.clear();
  vertexBytes_ = 0;
}

GpuTile* GpuTiles::find(const FacePath& path) {
  const auto found = tiles_.find(path);
  return found == tiles_.end() ? nullptr : found->second.get();
}

std::size_t GpuTiles::bytes() const noexcept {
  std::size_t sum = vertexBytes_;
  for (const auto& [path, tile] : tiles_)
    if (tile->relativePositions) sum += tile->relativePositions->bytes();
  for (const auto& [fingerprint, indices] : shared_)
    if (const auto held = indices.lock()) sum += held->buffer.bytes();
  return sum;
}

}  // namespace terrane

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

constexpr unsigned kPositionLocation = 0, kNormalLocation = 1, kColorLocation = 2, kRelativeLocation = 3;
using gl::Component, gl::Conversion;
constexpr std::array kAttributes{
    gl::VertexAttribute{kPositionLocation, 4, Component::U16, Conversion::Integer, offsetof(GpuVertex, offset)},
    gl::VertexAttribute{kNormalLocation, 3, Component::I16, Conversion::Float, offsetof(GpuVertex, normal)},
    gl::VertexAttribute{kColorLocation, 3, Component::U8, Conversion::Float, offsetof(GpuVertex, color)},
};
constexpr std::array kRelativeAttributes{
    gl::VertexAttribute{kRelativeLocation, 3, Component::F32, Conversion::Float, 0},
};

/// Those of a mesh that is no complete grid mean nothing. order: MeshLayout's.
std::vector<std::uint16_t> placesOf(const TileGrid& grid, const TileMesh& mesh,
                                    const std::vector<std::uint32_t>& order) {
  std::vector<std::uint16_t> byGridIndex;
  byGridIndex.reserve(static_cast<std::size_t>(grid.vertexCount()));
  for (int j = 0; j <= grid.cells; ++j)
    for (int i = 0; i <= grid.rowEnd(j); ++i)
      byGridIndex.push_back(static_cast<std::uint16_t>((i & 0xFF) | (j & 0xFF) << 8));
  std::vector<std::uint16_t> places(mesh.vertexCount());
  for (std::size_t place = 0; place < places.size(); ++place) {
    const std::size_t index = mesh.gridIndices[order.empty() ? place : order[place]];
    places[place] = index < byGridIndex.size() ? byGridIndex[index] : kSkirtPlace;
  }
  return places;
}

std::vector<GpuVertex> packVertices(const TileMesh& mesh, const MeshLayout& layout) {
  static const std::array<std::uint8_t, 256> displayBytes = makeDisplayBytes();
  std::vector<GpuVertex> vertices(mesh.vertexCount());
  for (std::size_t place = 0; place < vertices.size(); ++place) {
    GpuVertex& vertex = vertices[place];
    const std::size_t i = layout.order.empty() ? place : layout.order[place];
    for (std::size_t c = 0; c < 3; ++c) {
      vertex.offset[c] = mesh.offsets[3 * i + c];
      const float normal = std::clamp(mesh.normals[3 * i + c], -1.0f, 1.0f);
      vertex.normal[c] = static_cast<std::int16_t>(std::lround(normal * 32767.0f));
      vertex.color[c] = displayBytes[mesh.colors.empty() ? kPlainColor : mesh.colors[3 * i + c]];
    }
    vertex.place = layout.places[place];
  }
  return vertices;
}

}  // namespace

const std::vector<std::uint16_t>& GpuTile::heldOffsets() {
  if (offsets_.empty()) {
    std::vector<GpuVertex> held(vertexCount);
    vertices.read(0, std::as_writable_bytes(std::span(held)));
    offsets_.resize(3 * vertexCount);
    for (std::size_t i = 0; i < vertexCount; ++i)
      std::ranges::copy(held[i].offset, offsets_.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return offsets_;
}

const gl::BufferWords& GpuTile::words() {
  if (!words_) words_ = std::make_unique<gl::BufferWords>(vertices);
  return *words_;
}

void GpuTile::streamRelative(std::span<const float> positions) {
  if (!relativeArray_) {
    relativePositions_ = std::make_unique<gl::Buffer>();
    relativeArray_ = std::make_unique<gl::VertexArray>();
    relativeArray_->attach(vertices, sizeof(GpuVertex), kAttributes);
    relativeArray_->attach(*relativePositions_, 3 * sizeof(float), kRelativeAttributes);
  }
  relativeArray_->bind();
  relativePositions_->upload(gl::BufferTarget::Vertices, std::as_bytes(positions), gl::BufferUse::Stream);
}

std::size_t GpuTile::bytes() const noexcept {
  return vertices.bytes() + (relativePositions_ ? relativePositions_->bytes() : 0);
}

std::shared_ptr<TileIndices> GpuTiles::gridIndices(const TileGrid& grid, std::size_t& bytesTaken) {
  std::weak_ptr<TileIndices>& slot = grids_[grid];
  if (auto held = slot.lock()) return held;
  auto made = std::make_shared<TileIndices>(grid);
  bytesTaken += made->bytes();
  slot = made;
  return made;
}

std::shared_ptr<const MeshLayout> GpuTiles::layoutFor(const Tile& tile, std::size_t& bytesTaken) {
  const TileMesh& mesh = tile.mesh;
  const TileGrid grid{tile.metadata.path.scheme(), tile.metadata.cellsPerEdge};
  const XXH128_hash_t places = XXH3_128bits(mesh.gridIndices.data(), mesh.gridIndices.size() * sizeof(std::uint16_t));
  const XXH128_hash_t hash = XXH3_128bits_withSeed(mesh.triangles.data(), mesh.triangles.size() * sizeof(std::uint32_t),
                                                   places.low64 ^ static_cast<std::uint64_t>(grid.cells));
  std::weak_ptr<const MeshLayout>& slot = layouts_[{hash.low64 ^ places.high64, hash.high64}];
  if (auto held = slot.lock()) return held;

  auto made = std::make_shared<MeshLayout>();
  if (auto order = verticesInGridOrder(mesh, grid)) {
    made->order = std::move(*order);
    made->indices = gridIndices(grid, bytesTaken);
  } else {
    made->indices = std::make_shared<TileIndices>(tile);
    bytesTaken += made->indices->bytes();
  }
  made->places = placesOf(grid, mesh, made->order);
  slot = made;
  return made;
}

std::size_t GpuTiles::upload(const Tile& tile) {
  remove(tile.metadata.path);
  auto uploaded = std::make_unique<GpuTile>();
  std::size_t bytesTaken = 0;
  uploaded->metadata = tile.metadata;
  uploaded->serial = ++uploads_;
  uploaded->vertexCount = tile.mesh.vertexCount();
  uploaded->layout = layoutFor(tile, bytesTaken);
  uploaded->vertices.upload(gl::BufferTarget::Vertices, gl::bytesOf(packVertices(tile.mesh, *uploaded->layout)),
                            gl::BufferUse::Static);
  uploaded->array.attach(uploaded->vertices, sizeof(GpuVertex), kAttributes);
  gl::VertexArray::unbind();
  bytesTaken += uploaded->vertices.bytes();
  tiles_[tile.metadata.path] = std::move(uploaded);
  return bytesTaken;
}

void GpuTiles::remove(const FacePath& path) {
  if (tiles_.erase(path) == 0) return;
  const auto expired = [](const auto& entry) { return entry.second.expired(); };
  std::erase_if(layouts_, expired);
  std::erase_if(grids_, expired);
}

void GpuTiles::clear() {
  tiles_.clear();
  layouts_.clear();
  grids_.clear();
}

GpuTile* GpuTiles::find(const FacePath& path) {
  const auto found = tiles_.find(path);
  return found == tiles_.end() ? nullptr : found->second.get();
}

std::size_t GpuTiles::bytes() const noexcept {
  std::size_t sum = 0;
  for (const auto& [path, tile] : tiles_) sum += tile->bytes();
  for (const auto& [cells, indices] : grids_)
    if (const auto held = indices.lock()) sum += held->bytes();
  for (const auto& [fingerprint, layout] : layouts_)
    if (const auto held = layout.lock(); held && !held->indices->isGrid()) sum += held->indices->bytes();
  return sum;
}

}  // namespace terrane

#pragma once
// The tiles on the GPU: one interleaved vertex buffer a tile, and index buffers that tiles of equal connectivity share.
// A complete grid's vertices lie in grid order, whatever order they came in: then all such tiles share their indices,
// and where in the grid a vertex is tells its number. GL thread only.
//
// Nothing of a tile stays in main memory but its metadata; a placement that needs the offsets on the CPU reads them
// back once.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "client/gl/objects.h"
#include "client/render/tile_indices.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// The display's curve, as a plain power close to sRGB's: it lets colours be encoded once, at upload, and light apart
/// from them.
inline constexpr double kDisplayGamma = 2.2;

/// GpuVertex::place of a vertex that is of no grid.
inline constexpr std::uint16_t kSkirtPlace = 0xFFFF;

/// One vertex as it lies on the GPU.
struct GpuVertex {
  std::array<std::uint16_t, 3> offset{};  ///< steps from the tile's origin
  std::uint16_t place = 0;                ///< column + 256 row in the grid, or kSkirtPlace
  std::array<std::int16_t, 4> normal{};   ///< of 32767; the fourth pads
  /// (reflectance / kColorScale)^(1 / kDisplayGamma), of 255; the fourth pads.
  std::array<std::uint8_t, 4> color{};
};
static_assert(sizeof(GpuVertex) == 20);

/// How meshes of one connectivity are laid out and drawn.
struct MeshLayout {
  std::vector<std::uint32_t> order;   ///< the mesh's vertex at each place; empty: as they came
  std::vector<std::uint16_t> places;  ///< GpuVertex::place of each vertex as it lies on the GPU
  std::shared_ptr<TileIndices> indices;
};

struct GpuTile {
  TileMetadata metadata;
  std::uint64_t serial = 0;  ///< of the upload, from 1 on: no two are alike
  std::size_t vertexCount = 0;
  gl::Buffer vertices;
  gl::VertexArray array;
  std::shared_ptr<const MeshLayout> layout;

  /// The offsets, 3 a vertex; read back once.
  const std::vector<std::uint16_t>& heldOffsets();
  /// The vertices as a tile that morphs towards this one reads them.
  const gl::BufferWords& words();
  /// Uploads positions relative to the camera, 3 a vertex, and binds an array that uses them in place of the offsets.
  void streamRelative(std::span<const float> positions);
  std::size_t bytes() const noexcept;

 private:
  std::vector<std::uint16_t> offsets_;
  std::unique_ptr<gl::BufferWords> words_;
  std::unique_ptr<gl::Buffer> relativePositions_;
  std::unique_ptr<gl::VertexArray> relativeArray_;
};

class GpuTiles {
 public:
  /// Returns the bytes newly taken. A tile that is already there is replaced.
  std::size_t upload(const Tile& tile);
  void remove(const FacePath& path);
  void clear();
  GpuTile* find(const FacePath& path);
  std::size_t bytes() const noexcept;

 private:
  std::shared_ptr<const MeshLayout> layoutFor(const Tile& tile, std::size_t& bytesTaken);
  std::shared_ptr<TileIndices> gridIndices(const TileGrid& grid, std::size_t& bytesTaken);

  struct Fingerprint {
    std::uint64_t low = 0, high = 0;
    bool operator==(const Fingerprint&) const = default;
  };
  struct FingerprintHash {
    std::size_t operator()(const Fingerprint& f) const noexcept { return static_cast<std::size_t>(f.low); }
  };
  std::uint64_t uploads_ = 0;
  std::unordered_map<FacePath, std::unique_ptr<GpuTile>> tiles_;
  std::unordered_map<Fingerprint, std::weak_ptr<const MeshLayout>, FingerprintHash> layouts_;
  std::map<TileGrid, std::weak_ptr<TileIndices>> grids_;
};

}  // namespace terrane

#pragma once
// The tiles on the GPU: one interleaved vertex buffer a tile, and index buffers that tiles of equal connectivity share.
// GL thread only.
//
// Nothing of a tile stays in main memory but its metadata; a placement that needs the offsets on the CPU reads them
// back once.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "client/gl/objects.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// The display's curve, as a plain power close to sRGB's: it lets colours be encoded once, at upload, and light apart
/// from them.
inline constexpr double kDisplayGamma = 2.2;

/// One vertex as it lies on the GPU.
struct GpuVertex {
  std::array<std::uint16_t, 3> offset{};  ///< steps from the tile's origin
  std::uint16_t skirt = 0;                ///< 1 on a skirt
  std::array<std::int16_t, 4> normal{};   ///< signed, normalised; the fourth pads
  std::array<std::uint8_t, 4> color{};    ///< (reflectance / kColorScale)^(1 / kDisplayGamma); the fourth pads
};
static_assert(sizeof(GpuVertex) == 20);

/// Indices of one connectivity: triangles of the surface first, in an order that suits a vertex cache, then those of
/// the skirts.
struct SharedIndices {
  gl::Buffer buffer;
  std::size_t surfaceIndices = 0, skirtIndices = 0;
  bool wide = false;  ///< 32-bit indices
};

struct GpuTile {
  TileMetadata metadata;
  std::size_t vertexCount = 0;
  gl::Buffer vertices;
  gl::VertexArray array;
  std::shared_ptr<const SharedIndices> indices;

  /// Only once placed on the CPU: the offsets read back (3 a vertex), and an array whose positions come from a streamed
  /// buffer.
  std::vector<std::uint16_t> offsets;
  std::unique_ptr<gl::Buffer> relativePositions;
  std::unique_ptr<gl::VertexArray> relativeArray;

  /// Uploads relative positions for this camera and binds the array that uses them. cameraBody: metres.
  void placeOnCpu(const glm::dvec3& cameraBody, std::vector<float>& scratch);
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
  std::shared_ptr<const SharedIndices> indicesFor(const Tile& tile, std::size_t& bytesTaken);

  struct Fingerprint {
    std::uint64_t low = 0, high = 0;
    bool operator==(const Fingerprint&) const = default;
  };
  struct FingerprintHash {
    std::size_t operator()(const Fingerprint& f) const noexcept { return static_cast<std::size_t>(f.low); }
  };
  std::unordered_map<FacePath, std::unique_ptr<GpuTile>> tiles_;
  std::unordered_map<Fingerprint, std::weak_ptr<const SharedIndices>, FingerprintHash> shared_;
  std::size_t vertexBytes_ = 0;
};

}  // namespace terrane

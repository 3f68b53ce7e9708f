#pragma once
// TileMesh to and from a Draco bitstream (google/draco 1.5.x), on the lattice: POSITION is quantised explicitly with
// origin 0, range 65535, 16 bits, so that every offset is an integer that decodes exactly; in units of the step,
// because Draco prints the range with six decimals. Points are never de-duplicated: the connectivity of a kind of tile
// must not depend on its data. Thread-safe: no shared state.

#include <cstdint>
#include <span>
#include <vector>

#include "common/result.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// How offsets, colours and grid indices are predicted.
enum class DracoPrediction : std::uint8_t {
  StockAtSpeed,        ///< as libdraco does at that speed
  Parallelogram,       ///< libdraco's at speeds 2 to 7
  MultiParallelogram,  ///< by the mean of all parallelograms around; libdraco picks some of them, at speeds 0 and 1
};

/// How normals are predicted.
enum class DracoNormals : std::uint8_t {
  StockAtSpeed,
  Delta,      ///< by the one before; libdraco's from speed 4 on
  Geometric,  ///< by the triangles around; libdraco's below speed 4
};

struct DracoSettings {
  /// 0 (smallest) .. 10 (fastest). 4 takes a tenth fewer bytes than 7; a DracoTemplate and a DracoReader take the same
  /// time for both, libdraco a tenth more for 4, either way (bench_draco, bench_draco_decode). Above 7 tiles grow by a
  /// third.
  int speed = 4;
  int normalBits = 8;  ///< octahedral, 2..16
  /// Only a DracoTemplate can choose these, and any decoder of Draco reads them; encodeDraco predicts as libdraco does
  /// at the speed, whatever they say.
  DracoPrediction prediction = DracoPrediction::StockAtSpeed;
  DracoNormals normals = DracoNormals::StockAtSpeed;
};

struct DracoBuffer {
  std::vector<std::uint8_t> bytes;
  std::uint32_t vertexCount = 0, triangleCount = 0;
  int positionId = -1, normalId = -1, colorId = -1, gridId = -1;  ///< Draco's unique attribute ids, -1 if absent
};

/// The decoded mesh has the same vertices and triangles, in another order. Errors: InvalidArgument (array sizes, index
/// out of range, a normal that is zero or not finite, a vertex without triangle, a triangle with equal corners),
/// Internal (Draco refused).
Result<DracoBuffer> encodeDraco(const TileMesh& mesh, const DracoSettings& settings);

/// Most that a decoder accepts before it allocates. A tile of 128 cells with skirts fits (17,157 vertices; 270 KB if it
/// is all noise). libdraco takes up to 768 bytes of memory for a hostile byte, and accepted are at most
/// kMaxDracoBytesPerVertex bytes a vertex: 70 MB for a tile of 64 cells, 310 MB at these limits, given back before the
/// decoder returns.
struct DecodeLimits {
  std::uint32_t maxVertices = 20000;
  std::uint32_t maxTriangles = 40000;
  std::size_t maxBytes = 512u << 10;
};
/// Noise in all attributes, with normals of 16 bits, takes 15.7 (and 1 KB) at any speed.
inline constexpr std::size_t kMaxDracoBytesPerVertex = 20, kMaxDracoBytesBesides = 2048;

/// As in the glTF extension; -1 if absent, which only color may be.
struct DracoAttributeIds {
  int position = -1, normal = -1, color = -1, grid = -1;
  bool operator==(const DracoAttributeIds&) const = default;
};
/// Any bytes: a mesh or an error, bounded memory. Read is what encodeDraco can write: edgebreaker, version 2.2, one
/// connectivity, these attributes in these types and no others. Errors: Malformed, TooLarge, Unsupported.
Result<TileMesh> decodeDraco(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const DecodeLimits& limits);

}  // namespace terrane

#pragma once
// TileMesh to and from a Draco bitstream (google/draco 1.5.x), on the lattice: POSITION is quantised explicitly with origin 0, range
// 65535, 16 bits, so that every offset is an integer that decodes exactly; in units of the step, because Draco prints the range with
// six decimals. Points are never de-duplicated: the connectivity of a kind of tile must not depend on its data.
// Thread-safe: no shared state.

#include <cstdint>
#include <span>
#include <vector>

#include "common/result.h"
#include "proto/tile_mesh.h"

namespace terrane {

struct DracoSettings {
  int speed = 7;        ///< 0 (smallest) .. 10 (fastest)
  int normalBits = 8;   ///< octahedral
};

struct DracoBuffer {
  std::vector<std::uint8_t> bytes;
  std::uint32_t vertexCount = 0, triangleCount = 0;
  int positionId = -1, normalId = -1, colorId = -1, gridId = -1;  ///< Draco's unique attribute ids, -1 if absent
};

/// Errors: InvalidArgument (array sizes, index out of range, a normal that is zero or not finite), Internal (Draco refused).
Result<DracoBuffer> encodeDraco(const TileMesh& mesh, const DracoSettings& settings);

/// Most that a decoder accepts before it allocates. A tile of 128 cells with skirts fits.
struct DecodeLimits {
  std::uint32_t maxVertices = 32768;
  std::uint32_t maxTriangles = 65536;
  std::size_t maxBytes = 8u << 20;
};

/// Any bytes: a mesh or an error, bounded memory. ids as in the glTF extension. Errors: Malformed, TooLarge, Unsupported.
struct DracoAttributeIds {
  int position = -1, normal = -1, color = -1, grid = -1;
};
Result<TileMesh> decodeDraco(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids, const DecodeLimits& limits);

}  // namespace terrane

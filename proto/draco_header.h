#pragma once
// The fixed start of a Draco mesh bitstream (version 2.2, edgebreaker), read without libdraco: what a decoder must know
// before it lets a library allocate, and what an encoder checks its own output with. Private to proto. Thread-safe.
// Layout: "DRACO", u8 major, u8 minor, u8 geometry, u8 method, u16 flags; u8 traversal, varint vertices, varint faces,
// u8 attribute connectivities, varint symbols, varint split symbols.

#include <cstdint>
#include <span>

#include "common/result.h"

namespace terrane {

struct DracoHeader {
  std::uint32_t vertexCount = 0;
  std::uint32_t triangleCount = 0;
  std::uint32_t symbolCount = 0;
  std::uint32_t splitSymbolCount = 0;
  std::uint8_t attributeConnectivities = 0;  ///< 0 when all attributes share the position's, as Terrane writes
};

/// Any bytes. Errors: Malformed (not Draco, cut, counts that contradict each other), Unsupported (point cloud,
/// sequential method, metadata, another version).
Result<DracoHeader> readDracoHeader(std::span<const std::uint8_t> bytes);

}  // namespace terrane

#pragma once
// decodeDraco in parts, for what learns from libdraco's decoder. Private to proto. Thread-safe.

#include <cstdint>
#include <functional>
#include <span>

#include "proto/draco_header.h"
#include "proto/draco_mesh.h"

namespace draco {
class Mesh;
class MeshEdgebreakerDecoder;
}  // namespace draco

namespace terrane {

/// A stream that was decoded.
struct DracoDecoded {
  const draco::MeshEdgebreakerDecoder& decoder;
  const draco::Mesh& mesh;
  std::span<const std::uint8_t> head;  ///< of the stream: all before the attributes' values
  const TileMesh& tile;                ///< what decodeDraco will return
};
using DracoListener = std::function<void(const DracoDecoded&)>;

/// What decodeDraco refuses before it decodes anything.
Result<DracoHeader> checkDracoStream(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                                     const DecodeLimits& limits);

Result<TileMesh> decodeDraco(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const DecodeLimits& limits, const DracoListener& listener);  // not called after an error

}  // namespace terrane

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

/// What libdraco made of a stream: connectivity at least.
struct DracoDecoded {
  const draco::MeshEdgebreakerDecoder& decoder;
  const draco::Mesh& mesh;
  std::span<const std::uint8_t> head;  ///< of the stream: all before the attributes' values
};
/// Hears of every stream that decodes, and of the mesh that decodeDraco will return.
using DracoListener = std::function<void(const DracoDecoded&, const TileMesh&)>;

/// What decodeDraco refuses before it decodes anything.
Result<DracoHeader> checkDracoStream(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                                     const DecodeLimits& limits);

Result<TileMesh> decodeDraco(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const DecodeLimits& limits, const DracoListener& listener);

/// Decodes for the connectivity alone: listener hears of it even if the values are none. May throw std::exception.
void decodeDracoConnectivity(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                             const std::function<void(const DracoDecoded&)>& listener);

}  // namespace terrane

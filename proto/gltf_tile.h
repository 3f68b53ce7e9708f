#pragma once
// A tile as binary glTF 2.0 with KHR_draco_mesh_compression. The root node's matrix carries step, up axis and origin in
// doubles:
//   [s,0,0,0, 0,0,-s,0, 0,s,0,0, ox,oz,-oy,1]   (column-major; glTF is Y-up, the body frame Z-up)
// and its extras.terrane the metadata. Vertices and normals are in body axes. Shortest round-trip decimals, no -0, so
// that equal tiles are equal bytes. Thread-safe.

#include <cstdint>
#include <span>
#include <vector>

#include "common/result.h"
#include "proto/draco_mesh.h"
#include "proto/tile_mesh.h"

namespace terrane {

class DracoReader;

/// Wraps a mesh (for the accessor's bounds) and its encoding. Errors: InvalidArgument (a number of the metadata that is
/// not finite, except horizonPoint's, which is written as null; another mesh's encoding).
Result<std::vector<std::uint8_t>> writeTileGlb(const TileMetadata& metadata, const TileMesh& mesh,
                                               const DracoBuffer& draco);

/// encodeDraco and writeTileGlb.
Result<std::vector<std::uint8_t>> encodeTile(const Tile& tile, const DracoSettings& settings);

/// Any bytes: a tile or one clear error, bounded memory, no file or network access. Errors: Malformed, TooLarge,
/// Unsupported; field names the part ("header", "json", "bin", "extras.terrane.origin", "draco").
Result<Tile> decodeTile(std::span<const std::uint8_t> glb, const DecodeLimits& limits = {});

/// The same, by a reader that remembers kinds of tiles: for whoever decodes many.
Result<Tile> decodeTile(std::span<const std::uint8_t> glb, DracoReader& reader, const DecodeLimits& limits = {});

}  // namespace terrane

#pragma once
// The binary glTF container (glTF 2.0, section 4): a 12-byte header, one JSON chunk, one BIN chunk. Private to proto.
// Thread-safe.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/result.h"

namespace terrane {

struct GlbChunks {
  std::string_view json;              ///< padded with spaces
  std::span<const std::uint8_t> bin;  ///< padded with zeros
};

std::vector<std::uint8_t> packGlb(std::string_view json, std::span<const std::uint8_t> bin);

/// Any bytes; the chunks point into them. A GLB of exactly these two chunks. Errors: Malformed, Unsupported, naming
/// "header", "json" or "bin".
Result<GlbChunks> unpackGlb(std::span<const std::uint8_t> glb);

}  // namespace terrane

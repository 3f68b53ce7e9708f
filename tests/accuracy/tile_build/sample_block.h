#pragma once
// The blocks that experiments cut a tile's 65 x 65 vertices into, each a lunar::Block filled in part.

#include "server/fields/lunar_program.h"

namespace terrane::accuracy {

inline constexpr std::size_t kBlockSide = 13;
inline constexpr std::size_t kBlockSamples = 176;  ///< kBlockSide^2, rounded up to whole chunks
static_assert(kBlockSamples % lunar::kChunk == 0 && kBlockSamples <= lunar::kBlockCapacity);

}  // namespace terrane::accuracy

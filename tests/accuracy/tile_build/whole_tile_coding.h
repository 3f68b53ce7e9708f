#pragma once
// A whole tile, all attributes, encoded and decoded by libdraco or by what Terrane has learnt of it.

#include "proto/draco_mesh.h"
#include "proto/draco_template.h"
#include "proto/tile_mesh.h"

namespace terrane::accuracy {

struct WholeTileCoding {
  double encodeMs = 0, decodeMs = 0, kibibytes = 0;  ///< times are medians
  double worstOffsetSteps = 0;                       ///< of what is decoded, from what was encoded, in lattice steps
};

/// learnt: null for libdraco both ways. Throws where a coder refuses.
WholeTileCoding codeWholeTile(const Tile& tile, const DracoSettings& settings, const DracoTemplate* learnt, int rounds);

}  // namespace terrane::accuracy

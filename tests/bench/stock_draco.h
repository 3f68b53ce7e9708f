#pragma once
// The yardstick for tile builds: Draco as its own tools use it, on the very mesh of a tile. Edgebreaker, 16-bit
// positions, the tile's own normal width, colours and grid index as they are.

#include <cstddef>

#include "proto/draco_mesh.h"

namespace terrane::bench {

struct StockEncode {
  double milliseconds = 0;
  std::size_t bytes = 0;
};

/// deduplicate: merge equal attribute values and points first, as Draco's loaders do.
StockEncode encodeWithStockDraco(const TileMesh& mesh, const DracoSettings& settings, bool deduplicate);

}  // namespace terrane::bench

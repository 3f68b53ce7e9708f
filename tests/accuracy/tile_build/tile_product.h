#pragma once
// The product's own functions on the tiles of tile_chain.h: what the loops must give in double, bit for bit, and what
// they take.

#include <cstdint>
#include <vector>

#include "server/build/grid_directions.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/tile_build/tile_chain.h"

namespace terrane::accuracy {

/// The octaves of a place through the server's kernel.
class ProductNoise {
 public:
  ProductNoise(const Place& place, SimdPath path, const Columns<double>& blockPositions);
  /// By slot.
  std::vector<double> heightMeters();
  /// Of one line of blocks, the last height.
  double lastHeightMeters(std::size_t blockLine);

 private:
  std::vector<lunar::NoiseGroup> groups_;
  lunar::Program program_;
  lunar::EvaluateBlock evaluate_;
  std::vector<lunar::Block> blocks_;
};

/// x, y, z of each vertex in turn.
std::vector<std::int64_t> productLattice(const Place& place, const GridDirections& directions,
                                         const std::vector<double>& heightMeters);

/// Vertices of a whole tile of the server's Moon whose place or normal differs in a bit from what these loops make of
/// the same heights and gradients.
std::size_t builtVerticesThatDiffer(const TileLoopsOf<double>& loops, int level);

}  // namespace terrane::accuracy

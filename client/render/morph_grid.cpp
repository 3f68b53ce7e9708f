#include "client/render/morph_grid.h"

namespace terrane {
namespace {

/// Two origins that fit are less than a tile apart, 2^17 steps. Up to this all sums are exact in float too.
constexpr std::int64_t kMaxOriginSteps = std::int64_t{1} << 20;

}  // namespace

std::optional<MorphGrid> morphGrid(const TileMetadata& tile, const TileMetadata& parent) noexcept {
  if (tile.cellsPerEdge != parent.cellsPerEdge || tile.cellsPerEdge % 2 != 0) return std::nullopt;
  if (parent.stepExponent != tile.stepExponent + 1) return std::nullopt;
  MorphGrid grid;
  grid.side = tile.cellsPerEdge + 1;
  const int digit = tile.path.digit(tile.path.level() - 1), half = tile.cellsPerEdge / 2;
  grid.firstColumn = (digit & 1) != 0 ? half : 0;
  grid.firstRow = (digit & 2) != 0 ? half : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t apart = 2 * parent.origin[axis] - tile.origin[axis];
    if (apart > kMaxOriginSteps || apart < -kMaxOriginSteps) return std::nullopt;
    grid.parentMinusOwn[axis] = static_cast<std::int32_t>(apart);
  }
  return grid;
}

}  // namespace terrane

#include "client/render/morph_grid.h"

namespace terrane {
namespace {

/// Two origins that fit are less than a tile apart, 2^17 steps. Up to this all sums are exact in float too.
constexpr std::int64_t kMaxOriginSteps = std::int64_t{1} << 20;

}  // namespace

glm::ivec2 MorphGrid::firstInHalfCells() const noexcept {
  const auto [first, second] = grid.parentVertices(digit, {0, 0});
  return {first.i + second.i, first.j + second.j};
}

std::optional<MorphGrid> morphGrid(const TileMetadata& tile, const TileMetadata& parent) noexcept {
  if (tile.cellsPerEdge != parent.cellsPerEdge || tile.cellsPerEdge % 2 != 0) return std::nullopt;
  if (parent.stepExponent != tile.stepExponent + 1) return std::nullopt;
  MorphGrid grid;
  grid.grid = {tile.path.scheme(), tile.cellsPerEdge};
  grid.digit = tile.path.digit(tile.path.level() - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t apart = 2 * parent.origin[axis] - tile.origin[axis];
    if (apart > kMaxOriginSteps || apart < -kMaxOriginSteps) return std::nullopt;
    grid.parentMinusOwn[axis] = static_cast<std::int32_t>(apart);
  }
  return grid;
}

}  // namespace terrane

#include "client/render/tile_draw.h"

#include <algorithm>

namespace terrane {
namespace {

/// In double all three cases are one: target and own position are exact, and the target is the parent's.
void relativeMorphed(const TileDraw& draw, const glm::dvec3& cameraBody, std::vector<float>& out) {
  const std::vector<std::uint16_t>&own = draw.tile->heldOffsets(), &parents = draw.parent->heldOffsets();
  const double step = stepMeters(draw.tile->metadata.stepExponent);
  const LatticePoint& origin = draw.tile->metadata.origin;
  const TileGrid& grid = draw.grid.grid;
  for (int j = 0; j <= grid.cells; ++j) {
    for (int i = 0; i <= grid.rowEnd(j); ++i) {
      const auto at = 3 * static_cast<std::size_t>(grid.index({i, j}));
      const double morph = static_cast<double>(draw.byBorders[grid.borders({i, j})]);
      const ParentVertices target = draw.grid.parentVertices({i, j});
      const auto first = 3 * static_cast<std::size_t>(target.first),
                 second = 3 * static_cast<std::size_t>(target.second);
      for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const int toParent = draw.grid.parentMinusOwn[axis] + parents[first + k] + parents[second + k] - own[at + k];
        const double ownMeters = static_cast<double>(origin[axis] + own[at + k]) * step;
        // All the way there is the parent's own sum, for its bits; in between only vertices of this level must agree.
        out[at + k] = morph == 1 ? static_cast<float>((ownMeters + toParent * step) - cameraBody[axis])
                                 : static_cast<float>((ownMeters - cameraBody[axis]) + toParent * step * morph);
      }
    }
  }
}

}  // namespace

std::optional<TileDraw> makeTileDraw(GpuTiles& tiles, const DrawnTile& drawn, bool skirts, std::size_t wordLimit) {
  TileDraw draw;
  draw.tile = tiles.find(drawn.path);
  if (draw.tile == nullptr) return std::nullopt;
  const bool isGrid = draw.tile->layout->indices->isGrid();
  draw.skirts = skirts || !isGrid;
  if (drawn.morph == TileMorph{} || drawn.path.level() == 0) return draw;

  GpuTile* parent = tiles.find(drawn.path.parent());
  const bool bothGrids = isGrid && parent != nullptr && parent->layout->indices->isGrid();
  const auto grid = bothGrids ? morphGrid(draw.tile->metadata, parent->metadata) : std::nullopt;
  if (!grid || parent->vertices.bytes() / sizeof(std::uint32_t) > wordLimit) {
    draw.skirts = true;
    return draw;
  }
  draw.grid = *grid;
  draw.byBorders = morphByBorders(draw.grid.grid, drawn.morph);
  draw.coarserEdges = drawn.morph.coarserEdges;
  if (std::ranges::any_of(draw.byBorders, [](float value) { return value != 0; })) draw.parent = parent;
  return draw;
}

void placeOnCpu(const TileDraw& draw, const glm::dvec3& cameraBody, std::vector<float>& scratch) {
  GpuTile& tile = *draw.tile;
  const std::vector<std::uint16_t>& offsets = tile.heldOffsets();
  const double step = stepMeters(tile.metadata.stepExponent);
  const LatticePoint& origin = tile.metadata.origin;
  scratch.resize(offsets.size());
  for (std::size_t i = 0; i < scratch.size(); i += 3) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t at = i + static_cast<std::size_t>(axis);
      const auto steps = static_cast<double>(origin[axis] + offsets[at]);
      scratch[at] = static_cast<float>(steps * step - cameraBody[axis]);
    }
  }
  if (draw.parent != nullptr) relativeMorphed(draw, cameraBody, scratch);
  tile.streamRelative(scratch);
}

}  // namespace terrane

#pragma once
// A tile on the GPU with what it takes to draw it between its own surface and its parent's. GL thread only.

#include <array>
#include <optional>
#include <vector>

#include "client/render/gpu_tiles.h"
#include "client/render/morph_grid.h"

namespace terrane {

struct TileDraw {
  GpuTile* tile = nullptr;
  GpuTile* parent = nullptr;  ///< null: drawn as it is; grid and byBorders then mean nothing
  MorphGrid grid;
  MorphByBorders byBorders{};
  unsigned coarserEdges = 0;
  bool skirts = false;
};

/// Empty if the tile is not on the GPU. A tile that should morph and cannot (its parent is not there, or one of both is
/// no complete grid) is drawn as it is, and with its skirts, for its neighbours count on its edges. wordLimit: what a
/// shader can read of a buffer.
std::optional<TileDraw> makeTileDraw(GpuTiles& tiles, const DrawnTile& drawn, bool skirts, std::size_t wordLimit);

/// Uploads positions relative to this camera (metres, computed in double) and binds the array that uses them.
void placeOnCpu(const TileDraw& draw, const glm::dvec3& cameraBody, std::vector<float>& scratch);

}  // namespace terrane

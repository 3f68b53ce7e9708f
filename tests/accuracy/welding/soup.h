#pragma once
// Triangle soup of the icosahedral sphere: every triangle with corners of its own, so that a vertex of the surface is
// there about six times. A corner is a vertex of the grid of one tile.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/triangle_tile.h"

namespace terrane::accuracy {

struct Soup {
  std::vector<FacePath> tiles;              ///< all of one level
  int cells = 0;                            ///< along a tile's edge
  int gridLevel = 0;                        ///< of weights
  std::vector<std::uint32_t> gridVertices;  ///< a corner each: tile * triangleGridSize(cells) + triangleGridIndex;
                                            ///< three in turn are a triangle, counter-clockwise from outside

  std::size_t corners() const { return gridVertices.size(); }
  std::size_t gridSize() const { return static_cast<std::size_t>(triangleGridSize(cells)); }
};

/// Preconditions: tiles of the scheme Ico and of one level; cells a power of two, at most 2^15.
Soup soupOf(std::vector<FacePath> tiles, int cells);
/// 20 * 4^level triangles.
Soup wholeSphere(int level);
/// A tile of `cells` cells and all that touch it.
Soup tileWithNeighbours(const FacePath& tile, int cells);

/// Where a corner is, in integers. Face and weights as in triangle_tile.h.
struct Corner {
  int face = 0;
  FaceWeights weights{0};
};
std::vector<Corner> cornersOf(const Soup& soup);

/// How the copies of a vertex come by their coordinates.
enum class Copies : std::uint8_t {
  Alike,  ///< the same bits in all tiles, as icoGridDirections gives them
  Apart,  ///< each tile from its own corner: a + i / cells (b - a) + j / cells (c - a), normalised; roundings differ
};
/// Unit directions, one a corner of the soup.
template <class Real>
std::vector<glm::vec<3, Real>> positionsOf(const Soup& soup, Copies copies);

/// One value a vertex of the tiles' grids, put at every corner.
template <class T>
std::vector<T> atCorners(const Soup& soup, const std::vector<T>& ofGridVertices) {
  std::vector<T> out;
  out.reserve(soup.corners());
  for (const std::uint32_t vertex : soup.gridVertices) out.push_back(ofGridVertices[vertex]);
  return out;
}

}  // namespace terrane::accuracy

#pragma once
// Which vertices make a tile's triangles. Complete grids of one size share index lists, one for every set of edges
// towards coarser tiles; a mesh of any other shape keeps its own. The functions are pure; the class is for the GL
// thread only.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/gl/objects.h"
#include "common/tiling/tile_grid.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// A grid's surface by grid indices, in an order that suits a vertex cache. coarserEdges: TileMorph's bits; along such
/// an edge no odd vertex is used, so that its triangles meet a coarser tile's vertex for vertex. With a bit set, cells
/// must be even.
std::vector<std::uint16_t> gridTriangles(const TileGrid& grid, unsigned coarserEdges);
/// The walls below the edges; skirt vertices are numbered as TileMesh has them.
std::vector<std::uint16_t> skirtTriangles(const TileGrid& grid);

/// The mesh's vertex of each grid index, skirts last; empty unless the mesh is a complete grid with skirts and has
/// exactly the triangles above.
std::optional<std::vector<std::uint32_t>> verticesInGridOrder(const TileMesh& mesh, const TileGrid& grid);

struct IndexList {
  gl::Buffer buffer;
  std::size_t count = 0;
  bool wide = false;  ///< 32-bit indices
};

class TileIndices {
 public:
  /// Of complete grids, vertices in grid order.
  explicit TileIndices(const TileGrid& grid);
  /// Of a mesh as it came.
  explicit TileIndices(const Tile& tile);

  bool isGrid() const noexcept { return grid_.has_value(); }
  /// Built when first asked for. Only grids heed the bits.
  const IndexList& surface(unsigned coarserEdges);
  const IndexList& skirts() const noexcept { return skirts_; }
  std::size_t bytes() const noexcept;

 private:
  std::optional<TileGrid> grid_;
  std::array<std::optional<IndexList>, 1u << kEdgeCount> surfaces_;
  IndexList skirts_;
};

}  // namespace terrane

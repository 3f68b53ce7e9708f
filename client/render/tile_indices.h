#pragma once
// Which vertices make a tile's triangles. Complete grids of one size share index lists, one for every set of edges
// towards coarser tiles; a mesh of any other shape keeps its own. The functions are pure; the class is for the GL
// thread only.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/gl/objects.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// A grid's surface by grid indices, in an order that suits a vertex cache. coarserEdges: TileMorph's bits; along such
/// an edge no odd vertex is used, so that its triangles meet a coarser tile's vertex for vertex. With a bit set, cells
/// must be even.
std::vector<std::uint16_t> gridTriangles(int cells, unsigned coarserEdges);
/// The walls below the edges; skirt vertices are numbered as TileMesh has them.
std::vector<std::uint16_t> skirtTriangles(int cells);

/// The mesh's vertex of each grid index, skirts last; empty unless the mesh is a complete grid with skirts and has
/// exactly the triangles above.
std::optional<std::vector<std::uint32_t>> verticesInGridOrder(const TileMesh& mesh, int cells);

/// Where the vertex at (i, j) of the surface is drawn, by grid index: itself, or for an odd vertex of a coarser edge
/// the even one before it. Taking always the one before keeps the triangles of both edges apart at a corner.
int stitchedVertex(int cells, unsigned coarserEdges, int i, int j) noexcept;

struct IndexList {
  gl::Buffer buffer;
  std::size_t count = 0;
  bool wide = false;  ///< 32-bit indices
};

class TileIndices {
 public:
  /// Of complete grids, vertices in grid order.
  explicit TileIndices(int cells);
  /// Of a mesh as it came.
  explicit TileIndices(const Tile& tile);

  bool isGrid() const noexcept { return cells_ > 0; }
  /// Built when first asked for. Only grids heed the bits.
  const IndexList& surface(unsigned coarserEdges);
  const IndexList& skirts() const noexcept { return skirts_; }
  std::size_t bytes() const noexcept;

 private:
  int cells_ = 0;  ///< 0: no grid
  std::array<std::optional<IndexList>, 1u << kEdgeCount> surfaces_;
  IndexList skirts_;
};

}  // namespace terrane

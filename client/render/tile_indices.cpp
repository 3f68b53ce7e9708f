#include "client/render/tile_indices.h"

#include <algorithm>

namespace terrane {
namespace {

/// Cells on a side of the blocks in which triangles are drawn: 14 x 14 vertices then fit the 256 entries of the vertex
/// cache of software GL (and any GPU's), so that few vertices are shaded twice. In Draco's order of decoding many are.
constexpr int kBlockCells = 13;
/// Columns and rows are bytes on the GPU, and the skirts' mark lies beyond them.
constexpr int kMaxCells = 254;

template <class Index>
IndexList uploaded(const std::vector<Index>& indices) {
  IndexList list;
  // Not as Indices: that would change the vertex array that is bound, for a list may be made while tiles are drawn.
  list.buffer.upload(gl::BufferTarget::Vertices, gl::bytesOf(indices), gl::BufferUse::Static);
  list.count = indices.size();
  list.wide = sizeof(Index) > sizeof(std::uint16_t);
  return list;
}

/// Triangles as sortable values, whichever corner each begins with. Corners are below 2^16.
std::vector<std::uint64_t> sortedTriangles(const std::vector<std::uint16_t>& indices) {
  std::vector<std::uint64_t> sorted;
  sorted.reserve(indices.size() / 3);
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    std::array<std::uint64_t, 3> corners{indices[t], indices[t + 1], indices[t + 2]};
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    sorted.push_back(corners[0] << 32 | corners[1] << 16 | corners[2]);
  }
  std::ranges::sort(sorted);
  return sorted;
}

}  // namespace

std::vector<std::uint16_t> gridTriangles(const TileGrid& grid, unsigned coarserEdges) {
  const int cells = grid.cells;
  std::vector<std::uint16_t> indices;
  indices.reserve(6 * static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  const auto add = [&](const GridVertex& a, const GridVertex& b, const GridVertex& c) {
    std::array<int, 3> corners{};
    std::ranges::transform(std::array{a, b, c}, corners.begin(),
                           [&](const GridVertex& corner) { return grid.index(grid.stitched(coarserEdges, corner)); });
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    for (const int corner : corners) indices.push_back(static_cast<std::uint16_t>(corner));
  };
  for (int blockJ = 0; blockJ < cells; blockJ += kBlockCells) {
    for (int blockI = 0; blockI < cells; blockI += kBlockCells) {
      for (int j = blockJ; j < std::min(blockJ + kBlockCells, cells); ++j)
        for (int i = blockI; i < std::min(blockI + kBlockCells, grid.rowEnd(j)); ++i) grid.eachTriangle(i, j, add);
    }
  }
  return indices;
}

namespace {

/// The k-th vertex along the edge that the skirts have as their n-th (tile_mesh.h).
GridVertex skirtAnchor(const TileGrid& grid, int edge, int k) {
  const int cells = grid.cells;
  if (!grid.isSquare()) return edgeVertex(cells, edge, k);
  return std::array<GridVertex, 4>{
      {{k, 0}, {cells, k}, {cells - k, cells}, {0, cells - k}}}[static_cast<std::size_t>(edge)];
}

}  // namespace

std::vector<std::uint16_t> skirtTriangles(const TileGrid& grid) {
  std::vector<std::uint16_t> indices;
  for (int edge = 0; edge < edgeCount(grid.scheme); ++edge) {
    for (int k = 0; k < grid.cells; ++k) {
      const int top = grid.index(skirtAnchor(grid, edge, k)), nextTop = grid.index(skirtAnchor(grid, edge, k + 1));
      const int bottom = grid.vertexCount() + edge * (grid.cells + 1) + k, nextBottom = bottom + 1;
      for (const int corner : {top, bottom, nextTop, nextTop, bottom, nextBottom})
        indices.push_back(static_cast<std::uint16_t>(corner));
    }
  }
  return indices;
}

std::optional<std::vector<std::uint32_t>> verticesInGridOrder(const TileMesh& mesh, const TileGrid& grid) {
  const auto cells = static_cast<std::size_t>(grid.cells);
  const std::size_t skirts = skirtVertexCount(grid.scheme, grid.cells);
  const std::size_t count = gridVertexCount(grid.scheme, grid.cells) + skirts;
  const std::size_t triangles = (grid.isSquare() ? 2 : 1) * cells * cells + 2 * (skirts - skirts / (cells + 1));
  if (count > 65536 || grid.cells > kMaxCells || mesh.vertexCount() != count || mesh.triangles.size() != 3 * triangles)
    return std::nullopt;
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> order(count, kNone);
  for (std::size_t vertex = 0; vertex < count; ++vertex) {
    const std::size_t place = mesh.gridIndices[vertex];
    if (place >= count || order[place] != kNone) return std::nullopt;
    order[place] = static_cast<std::uint32_t>(vertex);
  }
  std::vector<std::uint16_t> own, standard = gridTriangles(grid, 0);
  own.reserve(mesh.triangles.size());
  for (const std::uint32_t vertex : mesh.triangles) own.push_back(mesh.gridIndices[vertex]);
  std::ranges::copy(skirtTriangles(grid), std::back_inserter(standard));
  if (sortedTriangles(own) != sortedTriangles(standard)) return std::nullopt;
  return order;
}

TileIndices::TileIndices(const TileGrid& grid) : grid_(grid) {
  surfaces_[0] = uploaded(gridTriangles(grid, 0));
  skirts_ = uploaded(skirtTriangles(grid));
}

TileIndices::TileIndices(const Tile& tile) {
  const TileMesh& mesh = tile.mesh;
  const std::size_t onGrid = gridVertexCount(tile.metadata.path.scheme(), tile.metadata.cellsPerEdge);
  std::vector<std::uint32_t> surface, skirts;
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    const auto corners = std::span(mesh.triangles).subspan(t, 3);
    const bool skirt = std::ranges::any_of(corners, [&](std::uint32_t v) { return mesh.gridIndices[v] >= onGrid; });
    std::ranges::copy(corners, std::back_inserter(skirt ? skirts : surface));
  }
  surfaces_[0] = uploaded(surface);
  skirts_ = uploaded(skirts);
}

const IndexList& TileIndices::surface(unsigned coarserEdges) {
  std::optional<IndexList>& list = surfaces_[isGrid() ? coarserEdges % surfaces_.size() : 0];
  if (!list) list = uploaded(gridTriangles(*grid_, coarserEdges));
  return *list;
}

std::size_t TileIndices::bytes() const noexcept {
  std::size_t sum = skirts_.buffer.bytes();
  for (const auto& list : surfaces_)
    if (list) sum += list->buffer.bytes();
  return sum;
}

}  // namespace terrane

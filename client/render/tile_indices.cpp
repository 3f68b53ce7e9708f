#include "client/render/tile_indices.h"

#include <algorithm>

namespace terrane {
namespace {

/// Cells on a side of the blocks in which triangles are drawn: 14 x 14 vertices then fit the 256 entries of the vertex
/// cache of software GL (and any GPU's), so that few vertices are shaded twice. In Draco's order of decoding many are.
constexpr int kBlockCells = 13;

bool hasEdge(unsigned edges, Side side) { return ((edges >> static_cast<unsigned>(side)) & 1u) != 0; }

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

int stitchedVertex(int cells, unsigned coarserEdges, int i, int j) noexcept {
  const bool alongU =
      (j == 0 && hasEdge(coarserEdges, Side::VMin)) || (j == cells && hasEdge(coarserEdges, Side::VMax));
  const bool alongV =
      (i == 0 && hasEdge(coarserEdges, Side::UMin)) || (i == cells && hasEdge(coarserEdges, Side::UMax));
  if (alongU) i &= ~1;
  if (alongV) j &= ~1;
  return j * (cells + 1) + i;
}

std::vector<std::uint16_t> gridTriangles(int cells, unsigned coarserEdges) {
  std::vector<std::uint16_t> indices;
  indices.reserve(6 * static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
  const auto add = [&](int a, int b, int c) {
    if (a == b || b == c || c == a) return;
    for (const int corner : {a, b, c}) indices.push_back(static_cast<std::uint16_t>(corner));
  };
  const auto at = [&](int i, int j) { return stitchedVertex(cells, coarserEdges, i, j); };
  for (int blockJ = 0; blockJ < cells; blockJ += kBlockCells) {
    for (int blockI = 0; blockI < cells; blockI += kBlockCells) {
      for (int j = blockJ; j < std::min(blockJ + kBlockCells, cells); ++j) {
        for (int i = blockI; i < std::min(blockI + kBlockCells, cells); ++i) {
          add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
          add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
      }
    }
  }
  return indices;
}

std::vector<std::uint16_t> skirtTriangles(int cells) {
  const int side = cells + 1;
  const auto anchor = [&](int edge, int k) {  // in the order of the skirts: VMin, UMax, VMax, UMin
    switch (edge) {
      case 0:
        return k;
      case 1:
        return k * side + cells;
      case 2:
        return cells * side + cells - k;
      default:
        return (cells - k) * side;
    }
  };
  std::vector<std::uint16_t> indices;
  for (int edge = 0; edge < kEdgeCount; ++edge) {
    for (int k = 0; k < cells; ++k) {
      const int top = anchor(edge, k), nextTop = anchor(edge, k + 1);
      const int bottom = side * side + edge * side + k, nextBottom = bottom + 1;
      for (const int corner : {top, bottom, nextTop, nextTop, bottom, nextBottom})
        indices.push_back(static_cast<std::uint16_t>(corner));
    }
  }
  return indices;
}

std::optional<std::vector<std::uint32_t>> verticesInGridOrder(const TileMesh& mesh, int cells) {
  const auto side = static_cast<std::size_t>(cells) + 1;
  const std::size_t count = side * side + kEdgeCount * side;
  const std::size_t triangles = 2 * (side - 1) * (side - 1) + 2 * kEdgeCount * (side - 1);
  if (count > 65536 || mesh.vertexCount() != count || mesh.triangles.size() != 3 * triangles) return std::nullopt;
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> order(count, kNone);
  for (std::size_t vertex = 0; vertex < count; ++vertex) {
    const std::size_t place = mesh.gridIndices[vertex];
    if (place >= count || order[place] != kNone) return std::nullopt;
    order[place] = static_cast<std::uint32_t>(vertex);
  }
  std::vector<std::uint16_t> own, standard = gridTriangles(cells, 0);
  own.reserve(mesh.triangles.size());
  for (const std::uint32_t vertex : mesh.triangles) own.push_back(mesh.gridIndices[vertex]);
  std::ranges::copy(skirtTriangles(cells), std::back_inserter(standard));
  if (sortedTriangles(own) != sortedTriangles(standard)) return std::nullopt;
  return order;
}

TileIndices::TileIndices(int cells) : cells_(cells) {
  surfaces_[0] = uploaded(gridTriangles(cells, 0));
  skirts_ = uploaded(skirtTriangles(cells));
}

TileIndices::TileIndices(const Tile& tile) {
  const TileMesh& mesh = tile.mesh;
  const int side = tile.metadata.cellsPerEdge + 1;
  std::vector<std::uint32_t> surface, skirts;
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    const auto corners = std::span(mesh.triangles).subspan(t, 3);
    const bool skirt =
        std::ranges::any_of(corners, [&](std::uint32_t v) { return mesh.gridIndices[v] >= side * side; });
    std::ranges::copy(corners, std::back_inserter(skirt ? skirts : surface));
  }
  surfaces_[0] = uploaded(surface);
  skirts_ = uploaded(skirts);
}

const IndexList& TileIndices::surface(unsigned coarserEdges) {
  std::optional<IndexList>& list = surfaces_[isGrid() ? coarserEdges % surfaces_.size() : 0];
  if (!list) list = uploaded(gridTriangles(cells_, coarserEdges));
  return *list;
}

std::size_t TileIndices::bytes() const noexcept {
  std::size_t sum = skirts_.buffer.bytes();
  for (const auto& list : surfaces_)
    if (list) sum += list->buffer.bytes();
  return sum;
}

}  // namespace terrane

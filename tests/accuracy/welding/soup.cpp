#include "tests/accuracy/welding/soup.h"

#include <bit>
#include <cmath>
#include <utility>

#include "common/tiling/ico_sphere.h"
#include "common/tiling/tile_neighbours.h"

namespace terrane::accuracy {
namespace {

template <class Real>
using Vector = glm::vec<3, Real>;

template <class Real>
Vector<Real> normalised(const Vector<Real>& p) {
  return p / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}

template <class Real>
void addAlike(const FacePath& tile, int cells, std::vector<Vector<Real>>& out) {
  const auto size = static_cast<std::size_t>(triangleGridSize(cells));
  std::vector<double> x(size), y(size), z(size);
  icoGridDirections(kIcoMap, tile, cells, {x, y, z});
  for (std::size_t v = 0; v < size; ++v) out.push_back(Vector<Real>(glm::dvec3(x[v], y[v], z[v])));
}

template <class Real>
void addApart(const FacePath& tile, int cells, std::vector<Vector<Real>>& out) {
  const auto corners = icoCornerDirections(kIcoMap, tile);
  const Vector<Real> a(corners[0]), b(corners[1]), c(corners[2]);
  const Real step = Real(1) / static_cast<Real>(cells);
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i + j <= cells; ++i)
      out.push_back(normalised(a + (b - a) * (static_cast<Real>(i) * step) + (c - a) * (static_cast<Real>(j) * step)));
}

}  // namespace

Soup soupOf(std::vector<FacePath> tiles, int cells) {
  Soup soup{std::move(tiles), cells, 0, {}};
  soup.gridLevel = soup.tiles.front().level() + std::countr_zero(static_cast<unsigned>(cells));
  std::uint32_t first = 0;
  const auto add = [&](const GridVertex& vertex) {
    soup.gridVertices.push_back(first + static_cast<std::uint32_t>(triangleGridIndex(cells, vertex)));
  };
  for (std::size_t tile = 0; tile < soup.tiles.size(); ++tile) {
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i + j < cells; ++i) {
        for (const GridVertex& vertex : {GridVertex{i, j}, GridVertex{i + 1, j}, GridVertex{i, j + 1}}) add(vertex);
        if (i + j + 1 == cells) continue;
        for (const GridVertex& vertex : {GridVertex{i + 1, j}, GridVertex{i + 1, j + 1}, GridVertex{i, j + 1}})
          add(vertex);
      }
    }
    first += static_cast<std::uint32_t>(soup.gridSize());
  }
  return soup;
}

Soup wholeSphere(int level) {
  std::vector<FacePath> faces;
  faces.reserve(kIcosahedronFaces);
  for (int face = 0; face < kIcosahedronFaces; ++face) faces.push_back(FacePath::wholeFace(Scheme::Ico, face));
  return soupOf(std::move(faces), 1 << level);
}

Soup tileWithNeighbours(const FacePath& tile, int cells) {
  std::vector<FacePath> tiles{tile};
  for (const FacePath& beside : tilesAround(tile)) tiles.push_back(beside);
  return soupOf(std::move(tiles), cells);
}

std::vector<Corner> cornersOf(const Soup& soup) {
  std::vector<Corner> ofGrids;
  for (const FacePath& path : soup.tiles) {
    const TriangleTile tile = triangleTile(path);
    for (int j = 0; j <= soup.cells; ++j)
      for (int i = 0; i + j <= soup.cells; ++i)
        ofGrids.push_back({path.face(), gridVertexWeights(tile, soup.cells, {i, j})});
  }
  return atCorners(soup, ofGrids);
}

template <class Real>
std::vector<glm::vec<3, Real>> positionsOf(const Soup& soup, Copies copies) {
  std::vector<Vector<Real>> ofGrids;
  ofGrids.reserve(soup.tiles.size() * soup.gridSize());
  for (const FacePath& tile : soup.tiles) {
    if (copies == Copies::Alike) {
      addAlike(tile, soup.cells, ofGrids);
    } else {
      addApart(tile, soup.cells, ofGrids);
    }
  }
  return atCorners(soup, ofGrids);
}
template std::vector<glm::vec<3, float>> positionsOf<float>(const Soup&, Copies);
template std::vector<glm::vec<3, double>> positionsOf<double>(const Soup&, Copies);

}  // namespace terrane::accuracy

#include "client/tiles/ground_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace terrane {
namespace {

/// Beside the mesh by less than this part of a triangle is on its edge: rounding to the lattice moves a vertex by at
/// most half a step of some 500 in a cell.
constexpr double kEdgeTolerance = 0.05;

/// How far the triangle that a point lies in may be from the cell that it would lie in without stitching, or from where
/// a walk towards it ended.
constexpr int kStitchReach = 2;

/// Weights of what is no triangle.
constexpr double kNoTriangle = -1e29;

double cross2(double ax, double ay, double bx, double by) { return ax * by - ay * bx; }

}  // namespace

/// Positions are taken relative to a point of the ray near the surface, so that millimetres do not drown in the radius.
struct GroundMesh::Ray {
  glm::dvec3 direction, across, along;  ///< orthonormal
  glm::dvec3 originFromAnchor;          ///< the tile's origin minus the anchor, metres
  double anchorMeters = 0;              ///< of the anchor, from the body's centre
  double step = 1;

  // Only for a tile that is drawn on its way to its parent.
  const GroundMesh* parent = nullptr;
  MorphByBorders byBorders{};
  unsigned coarserEdges = 0;
  int childDigit = 0;
  glm::dvec3 parentOriginFromAnchor;
};

/// One triangle of a triangular grid: of a cell the one that lies as the tile does, or the one turned round.
struct GroundMesh::Cell {
  int i = 0, j = 0;
  bool turned = false;

  std::array<GridVertex, 3> corners() const noexcept {
    if (turned) return {{{i + 1, j + 1}, {i, j + 1}, {i + 1, j}}};
    return {{{i, j}, {i + 1, j}, {i, j + 1}}};
  }
  /// That of the other kind beyond the side opposite a corner.
  Cell beyond(std::size_t corner) const noexcept {
    const int away = turned ? 1 : -1;
    return {i + (corner == 1 ? away : 0), j + (corner == 2 ? away : 0), !turned};
  }
  bool isOf(int cells) const noexcept { return i >= 0 && j >= 0 && i + j + (turned ? 1 : 0) < cells; }
};

namespace {

/// Which way every cell is cut.
std::vector<std::uint8_t> diagonalsOf(const TileMesh& mesh, const TileGrid& grid) {
  const auto cells = static_cast<std::size_t>(grid.cells), row = cells + 1, gridVertices = row * row;
  std::vector<std::uint8_t> diagonals((cells * cells + 7) / 8);
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    std::array<std::size_t, 3> corner{};
    bool onGrid = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[t + k];
      onGrid = onGrid && vertex < mesh.vertexCount() && mesh.gridIndices[vertex] < gridVertices;
      if (onGrid) corner[k] = mesh.gridIndices[vertex];
    }
    if (!onGrid) continue;
    const std::size_t left = std::min({corner[0] % row, corner[1] % row, corner[2] % row});
    const std::size_t bottom = std::min({corner[0] / row, corner[1] / row, corner[2] / row});
    // Of a cell's four corners a triangle has three; both ends of the diagonal are among them.
    const auto has = [&](std::size_t i, std::size_t j) {
      return std::find(corner.begin(), corner.end(), (bottom + j) * row + left + i) != corner.end();
    };
    if (has(0, 0) && has(1, 1)) {
      const std::size_t cell = bottom * cells + left;
      diagonals[cell / 8] = static_cast<std::uint8_t>(diagonals[cell / 8] | (1u << (cell % 8)));
    }
  }
  return diagonals;
}

}  // namespace

GroundMesh GroundMesh::fromTile(const Tile& tile) {
  const TileGrid grid{tile.metadata.path.scheme(), tile.metadata.cellsPerEdge};
  const TileMesh& source = tile.mesh;
  if (grid.cells < 1 || grid.cells > 255 || source.offsets.size() != 3 * source.vertexCount()) return {};
  const auto gridVertices = static_cast<std::size_t>(grid.vertexCount());

  GroundMesh mesh;
  mesh.offsets_.resize(3 * gridVertices);
  std::vector<bool> present(gridVertices);
  for (std::size_t vertex = 0; vertex < source.vertexCount(); ++vertex) {
    const std::size_t place = source.gridIndices[vertex];
    if (place >= gridVertices) continue;  // a skirt
    std::copy_n(source.offsets.begin() + static_cast<std::ptrdiff_t>(3 * vertex), 3,
                mesh.offsets_.begin() + static_cast<std::ptrdiff_t>(3 * place));
    present[place] = true;
  }
  if (!std::all_of(present.begin(), present.end(), [](bool there) { return there; })) return {};
  if (grid.isSquare()) mesh.diagonals_ = diagonalsOf(source, grid);
  mesh.grid_ = grid;
  mesh.stepExponent_ = tile.metadata.stepExponent;
  mesh.origin_ = tile.metadata.origin;
  return mesh;
}

std::size_t GroundMesh::bytes() const noexcept {
  return offsets_.size() * sizeof(offsets_[0]) + diagonals_.size() + sizeof(*this);
}

glm::dvec3 GroundMesh::offset(const GridVertex& at) const {
  const std::size_t first = 3 * static_cast<std::size_t>(grid_.index(at));
  return {offsets_[first], offsets_[first + 1], offsets_[first + 2]};
}

glm::dvec3 GroundMesh::vertex(const Ray& ray, const GridVertex& at) const {
  const glm::dvec3 own = ray.originFromAnchor + ray.step * offset(at);
  if (ray.parent == nullptr) return own;
  // Twice the parent's step times the mean of two offsets is the step times their sum.
  const auto [first, second] = grid_.parentVertices(ray.childDigit, at);
  const glm::dvec3 twice = ray.parent->offset(first) + ray.parent->offset(second);
  return own +
         static_cast<double>(ray.byBorders[grid_.borders(at)]) * (ray.parentOriginFromAnchor + ray.step * twice - own);
}

GroundMesh::Hit GroundMesh::meetTriangle(const Ray& ray, const std::array<GridVertex, 3>& corners) const {
  // Seen along the ray, the ray is the origin: its barycentric coordinates are ratios of areas.
  std::array<double, 3> x{}, y{}, depth{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 corner = vertex(ray, grid_.stitched(ray.coarserEdges, corners[k]));
    x[k] = glm::dot(corner, ray.across);
    y[k] = glm::dot(corner, ray.along);
    depth[k] = glm::dot(corner, ray.direction);
  }
  const std::array<double, 3> part{cross2(x[1], y[1], x[2], y[2]), cross2(x[2], y[2], x[0], y[0]),
                                   cross2(x[0], y[0], x[1], y[1])};
  const double area = part[0] + part[1] + part[2];
  if (area == 0) return {};
  return {{part[0] / area, part[1] / area, part[2] / area},
          (part[0] * depth[0] + part[1] * depth[1] + part[2] * depth[2]) / area};
}

GroundMesh::Hit GroundMesh::meetSquare(const Ray& ray, int i, int j) const {
  const auto cell = static_cast<std::size_t>(j) * static_cast<std::size_t>(grid_.cells) + static_cast<std::size_t>(i);
  const bool rising = (diagonals_[cell / 8] >> (cell % 8)) & 1u;
  const GridVertex v00{i, j}, v10{i + 1, j}, v01{i, j + 1}, v11{i + 1, j + 1};
  const Hit one = meetTriangle(ray, {v00, v10, rising ? v11 : v01});
  const Hit other = rising ? meetTriangle(ray, {v00, v11, v01}) : meetTriangle(ray, {v10, v11, v01});
  return other.inside() > one.inside() ? other : one;
}

GroundMesh::Ray GroundMesh::rayAlong(const glm::dvec3& direction) const {
  Ray ray;
  ray.direction = direction;
  const glm::dvec3 helper = std::abs(direction.z) < 0.5 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  ray.across = glm::normalize(glm::cross(helper, direction));
  ray.along = glm::cross(direction, ray.across);
  ray.step = stepMeters(stepExponent_);
  const glm::dvec3 origin = latticePosition(origin_, stepExponent_);
  ray.anchorMeters = glm::dot(origin, direction);
  ray.originFromAnchor = origin - ray.anchorMeters * direction;
  return ray;
}

std::optional<double> GroundMesh::heightMeters(const glm::dvec3& direction, double u, double v,
                                               double radiusMeters) const {
  if (empty()) return std::nullopt;
  return meet(rayAlong(direction), u, v, radiusMeters);
}

std::optional<double> GroundMesh::morphedHeightMeters(const glm::dvec3& direction, double u, double v,
                                                      double radiusMeters, const TileMorph& morph,
                                                      const GroundMesh& parent, int childDigit) const {
  if (empty()) return std::nullopt;
  Ray ray = rayAlong(direction);
  if (parent.grid_ == grid_ && grid_.cells % 2 == 0 && parent.stepExponent_ == stepExponent_ + 1) {
    ray.parent = &parent;
    ray.byBorders = morphByBorders(grid_, morph);
    ray.coarserEdges = morph.coarserEdges;
    ray.childDigit = childDigit;
    ray.parentOriginFromAnchor = latticePosition(parent.origin_, parent.stepExponent_) - ray.anchorMeters * direction;
  }
  return meet(ray, u, v, radiusMeters);
}

GroundMesh::Hit GroundMesh::meetSquares(const Ray& ray, double u, double v) const {
  const int cells = grid_.cells;
  const int i = std::clamp(static_cast<int>(std::floor(u * cells)), 0, cells - 1);
  const int j = std::clamp(static_cast<int>(std::floor(v * cells)), 0, cells - 1);
  Hit best = meetSquare(ray, i, j);
  // Near a cell's edge, rounding to the lattice may have moved the ray into the cell beside.
  for (int dj = -1; dj <= 1 && best.inside() < 0; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      if (i + di < 0 || j + dj < 0 || i + di >= cells || j + dj >= cells) continue;
      const Hit hit = meetSquare(ray, i + di, j + dj);
      if (hit.inside() > best.inside()) best = hit;
    }
  }
  return best;
}

GroundMesh::Hit GroundMesh::meetTriangles(const Ray& ray, double u, double v) const {
  const int cells = grid_.cells;
  const double x = std::clamp(u, 0.0, 1.0) * cells, y = std::clamp(v, 0.0, 1.0) * cells;
  Cell cell{std::min(static_cast<int>(x), cells - 1), 0, false};
  cell.j = std::min(static_cast<int>(y), cells - 1 - cell.i);
  Hit best;
  // From triangle to triangle towards the ray. A coarse tile's weights may be some cells off where its map is not that
  // of a plane.
  for (int walked = 0; walked < 4 * cells; ++walked) {
    const Hit hit = meetTriangle(ray, cell.corners());
    if (hit.inside() > best.inside()) best = hit;
    std::array<std::size_t, 3> outermost{0, 1, 2};
    std::ranges::sort(outermost, {}, [&](std::size_t k) { return hit.weights[k]; });
    const auto way = std::ranges::find_if(outermost, [&](std::size_t k) {
      return hit.weights[k] < 0 && hit.weights[k] > kNoTriangle && cell.beyond(k).isOf(cells);
    });
    if (way == outermost.end()) break;
    cell = cell.beyond(*way);
  }
  // Beside a coarser tile there are triangles without area, over which no way leads.
  const int reach = best.inside() < 0 && ray.coarserEdges != 0 ? kStitchReach : -1;
  for (int dj = -reach; dj <= reach; ++dj) {
    for (int di = -reach; di <= reach; ++di) {
      for (const bool turned : {false, true}) {
        const Cell other{cell.i + di, cell.j + dj, turned};
        if (!other.isOf(cells)) continue;
        const Hit hit = meetTriangle(ray, other.corners());
        if (hit.inside() > best.inside()) best = hit;
      }
    }
  }
  return best;
}

std::optional<double> GroundMesh::meet(const Ray& ray, double u, double v, double radiusMeters) const {
  const Hit hit = grid_.isSquare() ? meetSquares(ray, u, v) : meetTriangles(ray, u, v);
  if (hit.inside() < -kEdgeTolerance) return std::nullopt;
  return (ray.anchorMeters - radiusMeters) + hit.alongMeters;
}

}  // namespace terrane

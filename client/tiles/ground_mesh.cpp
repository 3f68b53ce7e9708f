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
  std::array<float, 9> byPlace{};
  int firstColumn = 0, firstRow = 0;  ///< of the parent's grid, where the tile's vertex (0, 0) lies
  glm::dvec3 parentOriginFromAnchor;
};

GroundMesh GroundMesh::fromTile(const Tile& tile) {
  const int cells = tile.metadata.cellsPerEdge;
  const TileMesh& source = tile.mesh;
  if (cells < 1 || cells > 255 || source.offsets.size() != 3 * source.vertexCount()) return {};
  const auto row = static_cast<std::size_t>(cells) + 1;
  const std::size_t gridVertices = row * row;

  GroundMesh mesh;
  mesh.offsets_.resize(3 * gridVertices);
  std::vector<bool> present(gridVertices);
  for (std::size_t vertex = 0; vertex < source.vertexCount(); ++vertex) {
    const std::size_t grid = source.gridIndices[vertex];
    if (grid >= gridVertices) continue;  // a skirt
    std::copy_n(source.offsets.begin() + static_cast<std::ptrdiff_t>(3 * vertex), 3,
                mesh.offsets_.begin() + static_cast<std::ptrdiff_t>(3 * grid));
    present[grid] = true;
  }
  if (!std::all_of(present.begin(), present.end(), [](bool there) { return there; })) return {};

  mesh.diagonals_.resize((static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells) + 7) / 8);
  for (std::size_t t = 0; t + 2 < source.triangles.size(); t += 3) {
    std::array<std::size_t, 3> corner{};
    bool onGrid = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = source.triangles[t + k];
      onGrid = onGrid && vertex < source.vertexCount() && source.gridIndices[vertex] < gridVertices;
      if (onGrid) corner[k] = source.gridIndices[vertex];
    }
    if (!onGrid) continue;
    const std::size_t left = std::min({corner[0] % row, corner[1] % row, corner[2] % row});
    const std::size_t bottom = std::min({corner[0] / row, corner[1] / row, corner[2] / row});
    // Of a cell's four corners a triangle has three; both ends of the diagonal are among them.
    const auto has = [&](std::size_t i, std::size_t j) {
      return std::find(corner.begin(), corner.end(), (bottom + j) * row + left + i) != corner.end();
    };
    if (has(0, 0) && has(1, 1)) {
      const std::size_t cell = bottom * (row - 1) + left;
      mesh.diagonals_[cell / 8] = static_cast<std::uint8_t>(mesh.diagonals_[cell / 8] | (1u << (cell % 8)));
    }
  }
  mesh.cells_ = cells;
  mesh.stepExponent_ = tile.metadata.stepExponent;
  mesh.origin_ = tile.metadata.origin;
  return mesh;
}

std::size_t GroundMesh::bytes() const noexcept {
  return offsets_.size() * sizeof(offsets_[0]) + diagonals_.size() + sizeof(*this);
}

glm::dvec3 GroundMesh::offset(int i, int j) const {
  const std::size_t at =
      3 * (static_cast<std::size_t>(j) * (static_cast<std::size_t>(cells_) + 1) + static_cast<std::size_t>(i));
  return {offsets_[at], offsets_[at + 1], offsets_[at + 2]};
}

glm::dvec3 GroundMesh::vertex(const Ray& ray, int i, int j) const {
  const glm::dvec3 own = ray.originFromAnchor + ray.step * offset(i, j);
  if (ray.parent == nullptr) return own;
  // Twice the parent's step times the mean of two offsets is the step times their sum.
  const int column = (i >> 1) + ray.firstColumn, row = (j >> 1) + ray.firstRow;
  const glm::dvec3 twice = ray.parent->offset(column, row) + ray.parent->offset(column + (i & 1), row + (j & 1));
  return own + static_cast<double>(morphAt(ray.byPlace, cells_ + 1, i, j)) *
                   (ray.parentOriginFromAnchor + ray.step * twice - own);
}

GroundMesh::Hit GroundMesh::meetCell(const Ray& ray, int i, int j) const {
  const std::array<glm::dvec3, 4> corner{vertex(ray, i, j), vertex(ray, i + 1, j), vertex(ray, i, j + 1),
                                         vertex(ray, i + 1, j + 1)};
  const auto cell = static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(i);
  const bool rising = (diagonals_[cell / 8] >> (cell % 8)) & 1u;
  using Triple = std::array<std::size_t, 3>;
  const std::array<Triple, 2> triangles = rising ? std::array<Triple, 2>{Triple{0, 1, 3}, Triple{0, 3, 2}}
                                                 : std::array<Triple, 2>{Triple{0, 1, 2}, Triple{1, 3, 2}};

  Hit best;
  for (const Triple& triangle : triangles) {
    // Seen along the ray, the ray is the origin: its barycentric coordinates are ratios of areas.
    std::array<double, 3> x{}, y{}, depth{};
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = glm::dot(corner[triangle[k]], ray.across);
      y[k] = glm::dot(corner[triangle[k]], ray.along);
      depth[k] = glm::dot(corner[triangle[k]], ray.direction);
    }
    const std::array<double, 3> part{cross2(x[1], y[1], x[2], y[2]), cross2(x[2], y[2], x[0], y[0]),
                                     cross2(x[0], y[0], x[1], y[1])};
    const double area = part[0] + part[1] + part[2];
    if (area == 0) continue;
    const double inside = std::min({part[0] / area, part[1] / area, part[2] / area});
    if (inside <= best.inside) continue;
    best.inside = inside;
    best.alongMeters = (part[0] * depth[0] + part[1] * depth[1] + part[2] * depth[2]) / area;
  }
  return best;
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
  if (parent.cells_ == cells_ && cells_ % 2 == 0 && parent.stepExponent_ == stepExponent_ + 1) {
    ray.parent = &parent;
    ray.byPlace = morphByPlace(morph);
    ray.firstColumn = (childDigit & 1) != 0 ? cells_ / 2 : 0;
    ray.firstRow = (childDigit & 2) != 0 ? cells_ / 2 : 0;
    ray.parentOriginFromAnchor = latticePosition(parent.origin_, parent.stepExponent_) - ray.anchorMeters * direction;
  }
  return meet(ray, u, v, radiusMeters);
}

std::optional<double> GroundMesh::meet(const Ray& ray, double u, double v, double radiusMeters) const {
  const int i = std::clamp(static_cast<int>(std::floor(u * cells_)), 0, cells_ - 1);
  const int j = std::clamp(static_cast<int>(std::floor(v * cells_)), 0, cells_ - 1);
  Hit best = meetCell(ray, i, j);
  // Near a cell's edge, rounding to the lattice may have moved the ray into the cell beside.
  for (int dj = -1; dj <= 1 && best.inside < 0; ++dj) {
    for (int di = -1; di <= 1; ++di) {
      if (i + di < 0 || j + dj < 0 || i + di >= cells_ || j + dj >= cells_) continue;
      const Hit hit = meetCell(ray, i + di, j + dj);
      if (hit.inside > best.inside) best = hit;
    }
  }
  if (best.inside < -kEdgeTolerance) return std::nullopt;
  return (ray.anchorMeters - radiusMeters) + best.alongMeters;
}

}  // namespace terrane

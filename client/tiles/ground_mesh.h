#pragma once
// What stays of a tile's mesh in main memory once it is on the GPU: the lattice offsets of its grid vertices in grid
// order and, of a square, the diagonal of every cell, 6 bytes a vertex. Answers how high the triangle under a direction
// is, as the tile has it or as it is drawn on its way to its parent. Body frame, metres; const is thread-safe.

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "common/view/drawn_tile.h"
#include "proto/tile_mesh.h"

namespace terrane {

class GroundMesh {
 public:
  GroundMesh() = default;
  /// Empty if the tile is no complete grid.
  static GroundMesh fromTile(const Tile& tile);

  bool empty() const noexcept { return grid_.cells == 0; }
  std::size_t bytes() const noexcept;

  /// Height above a sphere of radiusMeters of the point where the ray from the body's centre meets the mesh. direction:
  /// unit; (u, v): where it falls in the tile, of a triangle its weights at corners 1 and 2, 0..1, which only tells
  /// where to look first. Error <= 4 ulp of the radius
  /// (ground_mesh_test). Empty if the mesh is, or if the ray passes it by.
  std::optional<double> heightMeters(const glm::dvec3& direction, double u, double v, double radiusMeters) const;

  /// The same of the tile as it is drawn: every vertex moved by its morph towards the parent's mesh
  /// (client/render/morph_grid.h says where to). childDigit: which of the parent's children this is. Where the two
  /// grids do not fit on one another nothing moves, as on the screen.
  std::optional<double> morphedHeightMeters(const glm::dvec3& direction, double u, double v, double radiusMeters,
                                            const TileMorph& morph, const GroundMesh& parent, int childDigit) const;

 private:
  struct Ray;
  struct Hit {
    std::array<double, 3> weights{-1e30, -1e30, -1e30};  ///< barycentric coordinates: all >= 0 within the triangle
    double alongMeters = 0;
    double inside() const noexcept { return std::min({weights[0], weights[1], weights[2]}); }
  };
  struct Cell;
  Ray rayAlong(const glm::dvec3& direction) const;
  std::optional<double> meet(const Ray& ray, double u, double v, double radiusMeters) const;
  Hit meetSquares(const Ray& ray, double u, double v) const;
  Hit meetTriangles(const Ray& ray, double u, double v) const;
  Hit meetSquare(const Ray& ray, int i, int j) const;
  Hit meetTriangle(const Ray& ray, const std::array<GridVertex, 3>& corners) const;
  glm::dvec3 vertex(const Ray& ray, const GridVertex& at) const;
  glm::dvec3 offset(const GridVertex& at) const;

  TileGrid grid_;
  int stepExponent_ = 0;
  LatticePoint origin_{0};
  std::vector<std::uint16_t> offsets_;   ///< 3 a vertex, by grid index
  std::vector<std::uint8_t> diagonals_;  ///< of a square, a bit a cell: set if the diagonal joins corners 00 and 11
};

}  // namespace terrane

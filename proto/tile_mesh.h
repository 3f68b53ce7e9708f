#pragma once
// A terrain tile as data: what the builder makes, what the wire carries, what the client uploads. Plain values.

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_bounds.h"
#include "common/tiling/tile_neighbours.h"

namespace terrane {

/// The grid indices of a tile's surface: a square's or a triangle's vertices.
constexpr std::size_t gridVertexCount(Scheme scheme, int cellsPerEdge) noexcept {
  const auto side = static_cast<std::size_t>(cellsPerEdge) + 1;
  return scheme == Scheme::Cube ? side * side : side * (side + 1) / 2;
}
/// Those of its skirts, which follow.
constexpr std::size_t skirtVertexCount(Scheme scheme, int cellsPerEdge) noexcept {
  return static_cast<std::size_t>(edgeCount(scheme)) * (static_cast<std::size_t>(cellsPerEdge) + 1);
}

/// Vertices in structure-of-arrays form. Grid vertex (i, j) of a cube tile has grid index j * (cells + 1) + i, that of
/// an ico tile triangleGridIndex (triangle_grid.h). Skirt vertices follow from gridVertexCount on, cells + 1 for each
/// edge, which is walked counter-clockwise from outside and begins where the one before ends: VMin, UMax, VMax, UMin of
/// a cube tile, 0, 1, 2 of an ico tile.
struct TileMesh {
  std::vector<std::uint16_t> offsets;  ///< 3 a vertex: lattice steps from the tile's origin, body axes
  std::vector<float> normals;          ///< 3 a vertex: unit, body axes
  std::vector<std::uint8_t> colors;  ///< 3 a vertex: linear reflectance / kColorScale, empty if the body has one colour
  std::vector<std::uint16_t> gridIndices;  ///< 1 a vertex
  std::vector<std::uint32_t> triangles;    ///< 3 indices a triangle, counter-clockwise from outside
  std::size_t vertexCount() const noexcept { return gridIndices.size(); }
};

/// Linear reflectance that a colour byte of 255 stands for (lunar soil is dark: 8 bits would be wasted on 0..1).
inline constexpr float kColorScale = 0.4f;

/// extras.terrane of a tile's root node.
struct TileMetadata {
  FacePath path;
  int stepExponent = 0;        ///< step = 2^stepExponent metres
  LatticePoint origin{0};      ///< in steps
  HeightRange heights;         ///< of the tile's own vertices
  HeightRange subtreeHeights;  ///< proven to hold for every descendant too
  double geometricErrorMeters = 0;
  Sphere sphere;
  glm::dvec3 horizonPoint{0.0};
  int cellsPerEdge = 64;  ///< cells along each edge of the square or triangle
  float skirtMeters = 0;
};

struct Tile {
  TileMetadata metadata;
  TileMesh mesh;
};

}  // namespace terrane

#pragma once
// A terrain tile as data: what the builder makes, what the wire carries, what the client uploads. Plain values.

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "common/tiling/face_path.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_bounds.h"

namespace terrane {

/// Vertices in structure-of-arrays form. Grid vertex (i, j) has grid index j * (cells + 1) + i; skirt vertices follow
/// from (cells + 1)^2 on, in the order VMin, UMax, VMax, UMin edges (counter-clockwise from outside), cells + 1 each.
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
  int cellsPerEdge = 64;
  float skirtMeters = 0;
};

struct Tile {
  TileMetadata metadata;
  TileMesh mesh;
};

}  // namespace terrane

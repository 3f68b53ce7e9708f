#pragma once
// Maps of a face of the cube and of the icosahedron onto the sphere: how alike the cells are that each makes of a face,
// and work to time it by.

#include <span>
#include <string_view>

#include "common/tiling/face_path.h"
#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {

/// Of all cells of a face, which are as flat as they are small. Edges in nominal widths of a cell; angles in degrees.
/// Every cell of a deep tile is like one of these: cells of one place hardly change their shape with the level.
struct CellShapes {
  double areaRatio = 0;  ///< largest / smallest
  double shortestEdge = 0, longestEdge = 0;
  double leastAngle = 0, mostAngle = 0;
  double longestForWidth = 0;  ///< longest edge / shortest edge of one cell
  /// Of the triangles that are drawn: a cube's cell is cut in two.
  double leastDrawnAngle = 0, mostDrawnAngle = 0;
};

struct SphereMap {
  std::string_view name;
  Scheme scheme = Scheme::Cube;
  CellShapes (*shapes)(int cellsPerEdge) = nullptr;
  Work points;  ///< items are points, one by one
};

/// Precondition of shapes: cellsPerEdge is a power of two, at least 2, at most 2^15.
std::span<const SphereMap> sphereMaps();

/// The two that tiles are served by, and the icosahedron's other.
inline constexpr std::string_view kCubeMapName = "cube, equi-angular, own tan (Terrane)",
                                  kBisectedMapName = "icosahedron, bisected (Terrane)",
                                  kGnomonicMapName = "icosahedron, gnomonic";

}  // namespace terrane::accuracy

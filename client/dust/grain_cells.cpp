#include "client/dust/grain_cells.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/icosahedron.h"

namespace terrane {
namespace {

/// Of an equilateral triangle of width 1, inverted: a disc of diameter d stays inside if its middle stays within the
/// triangle shrunk towards its own by 1 - d kInverseInnerDiameter.
constexpr double kInverseInnerDiameter = 1.7320508075688772;
constexpr int kPlaceLevel = 58;

}  // namespace

std::optional<GrainPlace> SquareGrainCell::place(const FacePath& tile, double share, double first,
                                                 double second) const noexcept {
  const double columns = static_cast<double>(column) + (share / 2 + (1 - share) * first),
               rows = static_cast<double>(row) + (share / 2 + (1 - share) * second);
  const double span = std::ldexp(1.0, tile.level() - classLevel);
  const glm::dvec2 cells(columns * span - std::ldexp(tile.column(), kLog2GrainCells),
                         rows * span - std::ldexp(tile.row(), kLog2GrainCells));
  if (cells.x < 0 || cells.y < 0 || cells.x >= kGrainCells || cells.y >= kGrainCells) return std::nullopt;
  const double toFace = std::ldexp(2.0, -classLevel) / kGrainCells;
  return GrainPlace{cells, cubeDirection(face, columns * toFace - 1, rows * toFace - 1)};
}

std::optional<GrainPlace> TriangleGrainCell::place(const FacePath& tile, double share, double first,
                                                   double second) const noexcept {
  // Uniform in the triangle (Turk 1990, "Generating random points in triangles"), shrunk.
  const double shrunk = 1 - share * kInverseInnerDiameter, away = std::sqrt(first);
  const double weight1 = (1 - shrunk) / 3 + shrunk * (away * (1 - second)),
               weight2 = (1 - shrunk) / 3 + shrunk * (away * second);
  const std::int64_t cell = std::int64_t{1} << (kPlaceLevel - triangle.level);
  const auto whole1 = static_cast<std::int64_t>(weight1 * static_cast<double>(cell)),
             whole2 = static_cast<std::int64_t>(weight2 * static_cast<double>(cell));
  const FaceWeights in =
      triangle.base * cell + FaceWeights(cell - whole1 - whole2, whole1, whole2) * std::int64_t{triangle.sign};
  const FaceWeights thirds = in * std::int64_t{3} + FaceWeights(-2, 1, 1);

  const TriangleTile within = triangleTile(tile);
  const std::int64_t tileThirds = std::int64_t{3} << (kPlaceLevel - within.level);
  const FaceWeights own = (thirds - within.base * tileThirds) * std::int64_t{within.sign};
  if (own.x < 0 || own.y < 0 || own.z < 0) return std::nullopt;
  const double tileCells = kGrainCells / static_cast<double>(tileThirds);
  const auto& corners = icosahedronCorners(triangle.face);
  const glm::dvec3 chord = icosahedronVertex(corners[0]) * static_cast<double>(thirds.x) +
                           icosahedronVertex(corners[1]) * static_cast<double>(thirds.y) +
                           icosahedronVertex(corners[2]) * static_cast<double>(thirds.z);
  return GrainPlace{{static_cast<double>(own.y) * tileCells, static_cast<double>(own.z) * tileCells},
                    glm::normalize(chord)};
}

}  // namespace terrane

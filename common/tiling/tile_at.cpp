#include "common/tiling/tile_at.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"

namespace terrane {
namespace {

double tilesAlong(int level) noexcept { return static_cast<double>(std::uint64_t{1} << level); }

}  // namespace

FacePath tileAt(Scheme scheme, const glm::dvec3& direction, int level) noexcept {
  if (scheme == Scheme::Ico) return icoTileAt(kIcoMap, direction, level);
  const FaceCoordinates on = cubeFaceCoordinates(direction);
  const double tiles = tilesAlong(level);
  const auto index = [tiles](double coordinate) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(0.5 * (coordinate + 1.0) * tiles), 0.0, tiles - 1));
  };
  return FacePath::cubeTile(on.face, level, index(on.s), index(on.t));
}

glm::dvec2 placeInTile(const FacePath& tile, const glm::dvec3& direction) noexcept {
  if (tile.scheme() == Scheme::Cube) {
    const FaceCoordinates on = cubeFaceCoordinates(direction);
    const double tiles = tilesAlong(tile.level());
    return {0.5 * (on.s + 1.0) * tiles - tile.column(), 0.5 * (on.t + 1.0) * tiles - tile.row()};
  }
  // The weights of the corners whose sum has this direction.
  const auto corners = icoCornerDirections(kIcoMap, tile);
  const glm::dvec3 parts(glm::dot(glm::cross(corners[1], corners[2]), direction),
                         glm::dot(glm::cross(corners[2], corners[0]), direction),
                         glm::dot(glm::cross(corners[0], corners[1]), direction));
  return glm::dvec2(parts.y, parts.z) / (parts.x + parts.y + parts.z);
}

}  // namespace terrane

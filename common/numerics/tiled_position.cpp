#include "common/numerics/tiled_position.h"

#include <cmath>

namespace terrane {

TiledPosition tiledFromDouble(const glm::dvec3& meters, float tileMeters) noexcept {
  TiledPosition position;
  const auto size = static_cast<double>(tileMeters);
  for (int axis = 0; axis < 3; ++axis) {
    const double tile = std::floor(meters[axis] / size + 0.5);
    if (std::isfinite(tile)) position.tile[axis] = static_cast<std::int32_t>(tile);
    position.offsetMeters[axis] = static_cast<float>(meters[axis] - tile * size);
  }
  return regularised(position, tileMeters);  // an offset may have been rounded up to S/2
}

glm::dvec3 toDouble(const TiledPosition& position, float tileMeters) noexcept {
  return glm::dvec3(position.tile) * static_cast<double>(tileMeters) + glm::dvec3(position.offsetMeters);
}

TiledPosition regularised(const TiledPosition& position, float tileMeters) noexcept {
  TiledPosition regular = position;
  for (int axis = 0; axis < 3; ++axis) {
    const float tiles = std::floor(position.offsetMeters[axis] / tileMeters + 0.5f);
    if (!(std::fabs(tiles) < 0x1p30f)) continue;
    regular.tile[axis] += static_cast<std::int32_t>(tiles);
    regular.offsetMeters[axis] -= tiles * tileMeters;
  }
  return regular;
}

TiledPosition moved(const TiledPosition& position, const glm::vec3& byMeters, float tileMeters) noexcept {
  return regularised({position.tile, position.offsetMeters + byMeters}, tileMeters);
}

}  // namespace terrane

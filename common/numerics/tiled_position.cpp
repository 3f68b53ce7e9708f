#include "common/numerics/tiled_position.h"

#include <cmath>
#include <limits>

namespace terrane {

TiledPosition tiledFromDouble(const glm::dvec3& meters, float tileMeters) noexcept {
  TiledPosition position;
  const auto size = static_cast<double>(tileMeters);
  for (int axis = 0; axis < 3; ++axis) {
    double tile = std::floor(meters[axis] / size + 0.5);
    double offset = meters[axis] - tile * size;
    if (offset >= size / 2) {  // the half that was added may have been rounded
      tile += 1;
      offset -= size;
    }
    const bool reached = std::fabs(tile) < 0x1p31;
    position.tile[axis] = reached ? static_cast<std::int32_t>(tile) : 0;
    position.offsetMeters[axis] = reached ? static_cast<float>(offset) : std::numeric_limits<float>::quiet_NaN();
  }
  return regularised(position, tileMeters);  // an offset may have been rounded up to S/2
}

glm::dvec3 toDouble(const TiledPosition& position, float tileMeters) noexcept {
  return glm::dvec3(position.tile) * static_cast<double>(tileMeters) + glm::dvec3(position.offsetMeters);
}

TiledPosition regularised(const TiledPosition& position, float tileMeters) noexcept {
  TiledPosition regular = position;
  for (int axis = 0; axis < 3; ++axis) {
    // In double, in which adding the half is exact.
    const double offset = static_cast<double>(position.offsetMeters[axis]), size = static_cast<double>(tileMeters);
    const double tiles = std::floor(offset / size + 0.5);
    if (!(std::fabs(tiles) < 0x1p30)) continue;
    regular.tile[axis] += static_cast<std::int32_t>(tiles);
    regular.offsetMeters[axis] = static_cast<float>(offset - tiles * size);
  }
  return regular;
}

TiledPosition moved(const TiledPosition& position, const glm::vec3& byMeters, float tileMeters) noexcept {
  return regularised({position.tile, position.offsetMeters + byMeters}, tileMeters);
}

}  // namespace terrane

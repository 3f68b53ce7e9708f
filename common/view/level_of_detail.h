#pragma once
// Screen-space error: how many pixels a tile's geometric error covers, seen from the nearest point of its bounds.
// Thread-safe.

#include "common/tiling/tile_bounds.h"
#include "common/view/camera.h"

namespace terrane {

/// Distance from a point to an oriented box, 0 inside; metres.
double distanceMeters(const OrientedBox& box, const glm::dvec3& pointBody) noexcept;

/// geometricErrorMeters * pixelsPerRadian / distance; infinite at distance 0.
double screenSpaceErrorPixels(double geometricErrorMeters, const OrientedBox& box, const Camera& camera) noexcept;

}  // namespace terrane

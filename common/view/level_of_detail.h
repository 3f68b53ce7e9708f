#pragma once
// Screen-space error: how many pixels of the picture a tile's geometric error is worth, seen from the nearest point of
// its bounds. Thread-safe.
//
// A tile that is seen at a grazing angle shows its cells foreshortened, so it takes fewer of them to fill the picture
// as densely as one seen from above. The error is therefore scaled by the square root of the tile's area in the picture
// per area on the ground: sqrt of (the projected area of its box / the area of the box' top). Rough ground has a thick
// box and keeps its detail. The square root never counts as less than kLeastForeshortening, for against the sky even
// flat ground shows its outline undiminished.

#include "common/tiling/tile_bounds.h"
#include "common/view/camera.h"

namespace terrane {

inline constexpr double kLeastForeshortening = 0.4;

/// Distance from a point to an oriented box, 0 inside; metres.
double distanceMeters(const OrientedBox& box, const glm::dvec3& pointBody) noexcept;

/// kLeastForeshortening .. 1, as said above; 1 inside the box, and so far away that the distance is infinite.
/// halfAxes[2] is taken to be vertical. Continuous outside of the box.
double foreshortening(const OrientedBox& box, const glm::dvec3& pointBody) noexcept;

/// geometricErrorMeters * pixelsPerRadian / distance * foreshortening; infinite at distance 0, never NaN for a finite
/// camera.
double screenSpaceErrorPixels(double geometricErrorMeters, const OrientedBox& box, const Camera& camera) noexcept;

}  // namespace terrane

#pragma once
// Which background pixels should not be there: those whose ray meets the body's lowest sphere, over which a watertight
// surface leaves nothing open. Pure function of its arguments, double precision, thread-safe.

#include <cstdint>
#include <span>

#include "common/view/camera.h"

namespace terrane {

/// Values of the coverage pass's red channel.
inline constexpr std::uint8_t kCoverageNone = 0;
inline constexpr std::uint8_t kCoverageSurface = 255;

struct CoverageCount;

/// One of the spheres, around the camera's body.
struct LowestSphere {
  Camera camera;
  double radiusMeters = 0;
};

/// Cameras are one, each in its body's frame, at least one. pixels: the pass's red channel, bottom row first,
/// camera.widthPixels * camera.heightPixels of them. Anything but None and Surface is a skirt.
CoverageCount countCoveragePixels(std::span<const LowestSphere> spheres, std::span<const std::uint8_t> pixels);
CoverageCount countCoveragePixels(const Camera& camera, std::span<const std::uint8_t> pixels,
                                  double lowestRadiusMeters);

}  // namespace terrane

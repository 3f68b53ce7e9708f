#pragma once
// The built-in walk: a minute over some two hundred metres of ground, in a curve, looking left and right, at the
// heights below; slower the nearer the ground is. Heights, pace and view change smoothly. Thread-safe.

#include <array>

#include "client/flight/flight_file.h"

namespace terrane {

struct GroundHeight {
  double seconds = 0, metersAboveGround = 0;
};
/// Between two of them the height eases from the one to the other.
inline constexpr std::array<GroundHeight, 10> kGroundHeights{
    {{0, 2}, {10, 2}, {16, 0.5}, {20, 0.5}, {25, 0.2}, {31, 0.2}, {43, 30}, {46, 30}, {56, 2}, {60, 2}}};

/// From a place eastward, turning north. Radians, metres. The latitude is at most 85 degrees: nearer to a pole
/// "eastward" turns faster than the points follow.
Flight groundFlight(double longitude, double latitude, double radiusMeters);

}  // namespace terrane

#pragma once
// What the overlay and the figures say of each body in view. Plain data.

#include <cstddef>
#include <string>

namespace terrane {

/// One body of the scene in the last update.
struct BodyStatus {
  std::string name;
  double altitudeMeters = 0;  ///< of the camera above its reference sphere
  double diameterPixels = 0;  ///< of that sphere in the picture; infinite from within
  std::size_t tilesDrawn = 0, tilesResident = 0;
};

}  // namespace terrane

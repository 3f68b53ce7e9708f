#pragma once
// Whether the bodies of a scene keep clear of each other. Thread-safe.

#include <optional>
#include <span>

#include "common/scene/scene.h"

namespace terrane {

struct TouchingBodies {
  std::size_t first = 0, second = 0;  ///< first < second
  double distanceMeters = 0;          ///< between their centres
  double neededMeters = 0;            ///< the sum of the radii of their highest grounds
};

/// The first pair (by second, then first) whose ground might touch: the centres are no farther apart than the sum of
/// both radii and the highest heights that their fields can give (HeightField::heightRange). Bodies are valid
/// otherwise.
std::optional<TouchingBodies> findTouchingBodies(std::span<const Body> bodies);

}  // namespace terrane

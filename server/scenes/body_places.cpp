#include "server/scenes/body_places.h"

#include <glm/geometric.hpp>
#include <vector>

#include "server/fields/height_field.h"

namespace terrane {

std::optional<TouchingBodies> findTouchingBodies(std::span<const Body> bodies) {
  std::vector<std::optional<double>> outerRadii(bodies.size());
  const auto outerRadiusMeters = [&](std::size_t index) {
    std::optional<double>& radius = outerRadii[index];
    const Body& body = bodies[index];
    if (!radius) radius = body.radiusMeters + makeHeightField(body, SimdPath::Default)->heightRange().maxMeters;
    return *radius;
  };
  for (std::size_t second = 1; second < bodies.size(); ++second) {
    for (std::size_t first = 0; first < second; ++first) {
      const double distance = glm::length(bodies[second].positionScene - bodies[first].positionScene);
      // No ground is higher than its body's radius (proto/scene_json.h): far apart, no field need be asked.
      if (distance > 2 * (bodies[first].radiusMeters + bodies[second].radiusMeters)) continue;
      const double needed = outerRadiusMeters(first) + outerRadiusMeters(second);
      if (distance <= needed) return TouchingBodies{first, second, distance, needed};
    }
  }
  return std::nullopt;
}

}  // namespace terrane

#include "client/app/whole_body_pose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace terrane {

ViewPose wholeBodyPose(const SceneInfo& scene, const BodyInfo& body, double verticalFieldOfView, int widthPixels,
                       int heightPixels) {
  // The disc takes 85 % of the picture's shorter side: sin(half its angle) = R / (R + altitude).
  const double shorter = std::min(1.0, static_cast<double>(widthPixels) / heightPixels);
  const double halfAngle = 0.85 * std::atan(std::tan(verticalFieldOfView / 2) * shorter);
  ViewPose pose;
  pose.altitudeMeters = body.selection.radiusMeters * (1 / std::sin(halfAngle) - 1);
  pose.pitch = -std::numbers::pi / 2;
  for (const EffectCall& effect : scene.effects) {
    const auto longitude = effect.parameters.find("longitude"), latitude = effect.parameters.find("latitude");
    if (effect.kind != EffectKind::Sun || longitude == effect.parameters.end() || latitude == effect.parameters.end())
      continue;
    // West of where the sun stands overhead: there it is morning, and low light shows relief.
    pose.longitude = std::remainder(longitude->second - 62 * std::numbers::pi / 180, 2 * std::numbers::pi);
    pose.latitude = latitude->second;
  }
  return pose;
}

}  // namespace terrane

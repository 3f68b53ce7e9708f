#include "common/view/camera.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace terrane {
namespace {

/// Directions of a place on the sphere. Taken from longitude and latitude, never from the position, so that a pole has
/// a north (its meridian's) and the planet's centre an up.
struct LocalFrame {
  glm::dvec3 up, north, east;
};

LocalFrame localFrame(double longitude, double latitude) noexcept {
  const double cosLon = std::cos(longitude), sinLon = std::sin(longitude);
  const double cosLat = std::cos(latitude), sinLat = std::sin(latitude);
  return {
      {cosLat * cosLon, cosLat * sinLon, sinLat}, {-sinLat * cosLon, -sinLat * sinLon, cosLat}, {-sinLon, cosLon, 0.0}};
}

/// Below this sine of the angle to the vertical a view direction no longer tells its heading well: the up vector does.
constexpr double kVerticalView = 1e-6;

}  // namespace

Camera cameraFromPose(const ViewPose& pose, double radiusMeters, double verticalFieldOfView, int widthPixels,
                      int heightPixels) noexcept {
  const LocalFrame local = localFrame(pose.longitude, pose.latitude);
  const double cosHeading = std::cos(pose.heading), sinHeading = std::sin(pose.heading);
  const double cosPitch = std::cos(pose.pitch), sinPitch = std::sin(pose.pitch);
  const glm::dvec3 ahead = cosHeading * local.north + sinHeading * local.east;

  Camera camera;
  camera.positionBody = local.up * (radiusMeters + pose.altitudeMeters);
  camera.altitudeMeters = pose.altitudeMeters;
  // A second normalisation takes the error of the products (up to 4 u) back to one rounding.
  camera.backward = -glm::normalize(cosPitch * ahead + sinPitch * local.up);
  camera.right = glm::normalize(cosHeading * local.east - sinHeading * local.north);
  camera.up = glm::normalize(glm::cross(camera.backward, camera.right));
  if (pose.roll != 0) {
    camera.right = glm::normalize(std::cos(pose.roll) * camera.right - std::sin(pose.roll) * camera.up);
    camera.up = glm::normalize(glm::cross(camera.backward, camera.right));
  }
  camera.verticalFieldOfView = verticalFieldOfView;
  camera.widthPixels = widthPixels;
  camera.heightPixels = heightPixels;
  return camera;
}

ViewPose poseFromCamera(const Camera& camera) noexcept {
  ViewPose pose;
  pose.altitudeMeters = camera.altitudeMeters;
  const glm::dvec3& p = camera.positionBody;
  const double equatorial = std::hypot(p.x, p.y);
  if (equatorial > 0 || p.z != 0) {
    pose.longitude = std::atan2(p.y, p.x);
    pose.latitude = std::atan2(p.z, equatorial);
  }
  const LocalFrame local = localFrame(pose.longitude, pose.latitude);
  const glm::dvec3 forward = -camera.backward;
  const double climb = glm::dot(forward, local.up);
  glm::dvec3 level = forward - climb * local.up;
  const double levelLength = glm::length(level);
  pose.pitch = std::atan2(climb, levelLength);
  if (levelLength < kVerticalView) level = climb < 0 ? camera.up : -camera.up;
  pose.heading = std::atan2(glm::dot(level, local.east), glm::dot(level, local.north));
  const glm::dvec3 levelRight = std::cos(pose.heading) * local.east - std::sin(pose.heading) * local.north;
  const glm::dvec3 levelUp = glm::cross(camera.backward, levelRight);
  const double roll = std::atan2(-glm::dot(camera.right, levelUp), glm::dot(camera.right, levelRight));
  if (std::abs(roll) > 0x1p-48) pose.roll = roll;
  return pose;
}

Camera widened(const Camera& camera, double share) noexcept {
  const auto longer = [share](int pixels) { return pixels + 2 * static_cast<int>(std::ceil(share * pixels)); };
  Camera wide = camera;
  wide.widthPixels = longer(camera.widthPixels);
  wide.heightPixels = longer(camera.heightPixels);
  const double scale = static_cast<double>(wide.heightPixels) / camera.heightPixels;
  wide.verticalFieldOfView = 2 * std::atan(scale * std::tan(camera.verticalFieldOfView / 2));
  return wide;
}

glm::dmat3 viewRotation(const Camera& camera) noexcept {
  const glm::dvec3 &r = camera.right, &u = camera.up, &b = camera.backward;
  return glm::dmat3(r.x, u.x, b.x, r.y, u.y, b.y, r.z, u.z, b.z);
}

glm::dmat4 reversedInfiniteProjection(const Camera& camera) noexcept {
  const double focal = 1.0 / std::tan(0.5 * camera.verticalFieldOfView);
  const double aspect = static_cast<double>(camera.widthPixels) / static_cast<double>(camera.heightPixels);
  glm::dmat4 projection(0.0);
  projection[0][0] = focal / aspect;
  projection[1][1] = focal;
  projection[2][3] = -1.0;
  projection[3][2] = camera.nearMeters;
  return projection;
}

double pixelsPerRadian(const Camera& camera) noexcept {
  return 0.5 * camera.heightPixels / std::tan(0.5 * camera.verticalFieldOfView);
}

}  // namespace terrane

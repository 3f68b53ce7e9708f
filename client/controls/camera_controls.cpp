#include "client/controls/camera_controls.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace terrane {
namespace {

constexpr double kHalfPi = std::numbers::pi / 2;
constexpr double kZoomPerStep = 0.22;  // a wheel step changes the height by a factor e^0.22 = 1.25
constexpr double kZoomSeconds = 0.12;  // time constants of the smoothing
constexpr double kVelocitySeconds = 0.18;
constexpr double kSpinSeconds = 0.30;
constexpr double kRollSeconds = 0.5, kLeastRoll = 1e-4;
constexpr double kLongestStepSeconds = 0.1;
constexpr double kHighestRadii = 60;
// A point further away than this many heights is not followed exactly: near the horizon a pixel is kilometres.
constexpr double kFarthestGrabHeights = 30;

double wrapAngle(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& unitAxis, double angle) {
  const double c = std::cos(angle);
  return v * c + glm::cross(unitAxis, v) * std::sin(angle) + unitAxis * (glm::dot(unitAxis, v) * (1 - c));
}

// What the cursor points at: a unit direction from the body's centre, and its distance from the camera.
struct Grab {
  glm::dvec3 direction;
  double distanceMeters;
};

// The sphere through the ground below the camera; a ray that passes it by grabs the point where it comes nearest.
std::optional<Grab> grab(const Camera& camera, const glm::dvec2& cursorPixels, double sphereMeters,
                         double heightMeters) {
  const double tangent = std::tan(camera.verticalFieldOfView / 2);
  const double x = (2 * cursorPixels.x / camera.widthPixels - 1) * tangent * camera.widthPixels / camera.heightPixels;
  const double y = (1 - 2 * cursorPixels.y / camera.heightPixels) * tangent;
  const glm::dvec3 ray = glm::normalize(camera.right * x + camera.up * y - camera.backward);
  const glm::dvec3 position = glm::normalize(camera.positionBody) * (sphereMeters + heightMeters);
  const double along = glm::dot(position, ray);
  if (along >= 0) return std::nullopt;
  const double discriminant = along * along - heightMeters * (2 * sphereMeters + heightMeters);
  // The nearer root in the form that does not cancel close to the ground.
  const double distance =
      discriminant > 0 ? heightMeters * (2 * sphereMeters + heightMeters) / (-along + std::sqrt(discriminant)) : -along;
  return Grab{glm::normalize(position + ray * distance), distance};
}

}  // namespace

std::string_view controlModeName(ControlMode mode) noexcept {
  return mode == ControlMode::Orbit ? "orbit" : "free flight";
}

glm::dvec3 directionOf(double longitude, double latitude) noexcept {
  const double c = std::cos(latitude);
  return {c * std::cos(longitude), c * std::sin(longitude), std::sin(latitude)};
}

double freeSpeedMetersPerSecond(double heightAboveGroundMeters, double radiusMeters) noexcept {
  return std::clamp(0.8 * heightAboveGroundMeters, 0.25, 0.5 * radiusMeters);
}

void CameraControls::setPose(const ViewPose& pose) {
  pose_ = pose;
  stop();
}

void CameraControls::moveOver(const ViewPose& pose) {
  pose_ = pose;
  pendingZoom_ = 0;
  spinPerSecond_ = glm::dvec3(0.0);
}

void CameraControls::level(double seconds) noexcept {
  pose_.roll *= std::exp(-seconds / kRollSeconds);
  if (std::abs(pose_.roll) < kLeastRoll) pose_.roll = 0;
}

void CameraControls::stop() noexcept {
  pendingZoom_ = 0;
  spinPerSecond_ = velocity_ = glm::dvec3(0.0);
  speedMetersPerSecond_ = 0;
}

void CameraControls::toggleMode() {
  mode_ = mode_ == ControlMode::Orbit ? ControlMode::FreeFly : ControlMode::Orbit;
  stop();
}

bool CameraControls::moving() const noexcept {
  return pendingZoom_ != 0 || spinPerSecond_ != glm::dvec3(0.0) || velocity_ != glm::dvec3(0.0) || pose_.roll != 0;
}

ViewPose CameraControls::advance(const ControlInput& input, const ControlView& view, const GroundHeight& ground) {
  const double seconds = std::clamp(input.seconds, 0.0, kLongestStepSeconds);
  const glm::dvec3 before = directionOf(pose_.longitude, pose_.latitude);
  const double altitudeBefore = pose_.altitudeMeters;
  const double groundMeters = ground(before).value_or(0.0);
  const double height = std::max(pose_.altitudeMeters - groundMeters, kLowestHeightAboveGroundMeters);

  pendingZoom_ -= kZoomPerStep * input.wheelSteps;
  zoom(seconds, groundMeters);
  if (mode_ == ControlMode::Orbit) {
    if (input.primaryButton)
      drag(input, view, height, groundMeters);
    else
      spinOn(seconds, view.radiusMeters, height);
    if (input.secondaryButton) look(input.cursorMovePixels, view);
  } else if (input.primaryButton || input.secondaryButton) {
    look(input.cursorMovePixels, view);
  }
  fly(input, view, seconds, height);
  level(seconds);

  const glm::dvec3 after = directionOf(pose_.longitude, pose_.latitude);
  if (const auto known = ground(after))
    pose_.altitudeMeters = std::max(pose_.altitudeMeters, *known + kLowestHeightAboveGroundMeters);
  pose_.altitudeMeters =
      std::min(pose_.altitudeMeters, kHighestRadii * std::max(view.radiusMeters, view.largestRadiusMeters));
  if (seconds > 0) {
    const glm::dvec3 moved = (after - before) * (view.radiusMeters + pose_.altitudeMeters);
    speedMetersPerSecond_ = std::hypot(glm::length(moved), pose_.altitudeMeters - altitudeBefore) / seconds;
  }
  return pose_;
}

void CameraControls::drag(const ControlInput& input, const ControlView& view, double heightAboveGround,
                          double groundMeters) {
  if (input.cursorMovePixels == glm::dvec2(0.0)) {
    if (input.seconds > 0) spinPerSecond_ = glm::dvec3(0.0);  // held still: nothing is thrown
    return;
  }
  const Camera camera =
      cameraFromPose(pose_, view.radiusMeters, view.verticalFieldOfView, view.widthPixels, view.heightPixels);
  const double sphere = view.radiusMeters + groundMeters;
  const auto from = grab(camera, input.cursorPixels - input.cursorMovePixels, sphere, heightAboveGround);
  const auto to = grab(camera, input.cursorPixels, sphere, heightAboveGround);
  if (!from || !to) return;
  const glm::dvec3 normal = glm::cross(to->direction, from->direction);
  const double sine = glm::length(normal);
  if (!(sine > 0)) return;
  // Turning the camera by to -> from about the centre brings the grabbed point under the cursor's new place.
  const double distance = std::max(from->distanceMeters, to->distanceMeters);
  const double angle = std::atan2(sine, glm::dot(to->direction, from->direction)) *
                       std::min(1.0, kFarthestGrabHeights * heightAboveGround / distance);
  rotateAboutCentre(normal / sine, angle);
  const double seconds = std::clamp(input.seconds, 1e-3, kLongestStepSeconds);
  spinPerSecond_ = normal / sine * (angle / seconds);
}

void CameraControls::spinOn(double seconds, double radiusMeters, double heightAboveGround) {
  const double rate = glm::length(spinPerSecond_);
  if (rate == 0) return;
  rotateAboutCentre(spinPerSecond_ / rate, rate * seconds);
  spinPerSecond_ *= std::exp(-seconds / kSpinSeconds);
  // Over once the ground passes by at a thousandth of the height a second: about a pixel a second.
  if (rate * radiusMeters < 1e-3 * heightAboveGround) spinPerSecond_ = glm::dvec3(0.0);
}

void CameraControls::look(const glm::dvec2& movePixels, const ControlView& view) {
  const double radiansPerPixel = view.verticalFieldOfView / view.heightPixels;
  pose_.heading = wrapAngle(pose_.heading - movePixels.x * radiansPerPixel);
  pose_.pitch = std::clamp(pose_.pitch + movePixels.y * radiansPerPixel, -kHalfPi, kHalfPi);
}

void CameraControls::zoom(double seconds, double groundMeters) {
  if (pendingZoom_ == 0) return;
  double step = pendingZoom_ * (1 - std::exp(-seconds / kZoomSeconds));
  if (std::abs(pendingZoom_) < 1e-3) step = pendingZoom_;
  const double height = std::max(pose_.altitudeMeters - groundMeters, kLowestHeightAboveGroundMeters);
  pose_.altitudeMeters = groundMeters + std::max(height * std::exp(step), kLowestHeightAboveGroundMeters);
  pendingZoom_ -= step;
}

void CameraControls::fly(const ControlInput& input, const ControlView& view, double seconds, double heightAboveGround) {
  const glm::dvec3 target = glm::clamp(input.move, -1.0, 1.0) * input.speedFactor;
  velocity_ = target + (velocity_ - target) * std::exp(-seconds / kVelocitySeconds);
  if (target == glm::dvec3(0.0) && glm::length(velocity_) < 1e-3) velocity_ = glm::dvec3(0.0);
  if (velocity_ == glm::dvec3(0.0)) return;
  const double metres =
      freeSpeedMetersPerSecond(heightAboveGround, std::max(view.radiusMeters, view.largestRadiusMeters)) * seconds;
  // Forward is along the view: part of it level, along the heading's great circle, and part of it climb.
  const double level = velocity_.z * std::cos(pose_.pitch);
  const double climb = velocity_.z * std::sin(pose_.pitch) + velocity_.y;
  const double north = level * std::cos(pose_.heading) - velocity_.x * std::sin(pose_.heading);
  const double east = level * std::sin(pose_.heading) + velocity_.x * std::cos(pose_.heading);
  pose_.altitudeMeters += climb * metres;
  const double along = std::hypot(north, east);
  if (!(along > 0)) return;
  const glm::dvec3 out = directionOf(pose_.longitude, pose_.latitude);
  const glm::dvec3 eastward{-std::sin(pose_.longitude), std::cos(pose_.longitude), 0};
  const glm::dvec3 northward = glm::cross(out, eastward);
  const glm::dvec3 way = (northward * north + eastward * east) / along;
  rotateAboutCentre(glm::cross(out, way), along * metres / (view.radiusMeters + pose_.altitudeMeters));
}

// Turns position and view together, so altitude, pitch and (no) roll stay as they are; only place and heading change.
void CameraControls::rotateAboutCentre(const glm::dvec3& axis, double angle) {
  const glm::dvec3 out = directionOf(pose_.longitude, pose_.latitude);
  const glm::dvec3 eastward{-std::sin(pose_.longitude), std::cos(pose_.longitude), 0};
  const glm::dvec3 northward = glm::cross(out, eastward);
  const glm::dvec3 ahead = northward * std::cos(pose_.heading) + eastward * std::sin(pose_.heading);
  const glm::dvec3 newOut = rotated(out, axis, angle);
  const glm::dvec3 newAhead = rotated(ahead, axis, angle);
  pose_.latitude = std::atan2(newOut.z, std::hypot(newOut.x, newOut.y));
  if (newOut.x != 0 || newOut.y != 0) pose_.longitude = std::atan2(newOut.y, newOut.x);
  const glm::dvec3 newEast{-std::sin(pose_.longitude), std::cos(pose_.longitude), 0};
  pose_.heading = std::atan2(glm::dot(newAhead, newEast), glm::dot(newAhead, glm::cross(newOut, newEast)));
}

}  // namespace terrane

#pragma once
// How a person's hands move the camera: two modes over a round body, free of any window system, so that they can be
// tested.
//   Orbit    a drag turns the body under the cursor (the grabbed point stays under it), the wheel changes the height
//   above ground by
//            a factor, the secondary button tilts and turns the view
//   FreeFly  move keys fly level with the ground or up and down, any drag looks around; the speed follows the height
//   above ground
// All motion is smoothed: zoom and velocity approach their targets exponentially, a thrown body spins on for a moment.
// Body frame, metres, radians, seconds, pixels from the top left corner. One thread.

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string_view>

#include "common/view/camera.h"

namespace terrane {

enum class ControlMode : std::uint8_t { Orbit, FreeFly };
std::string_view controlModeName(ControlMode mode) noexcept;

/// The camera never comes nearer to the ground than this.
inline constexpr double kLowestHeightAboveGroundMeters = 0.15;

/// What the hands did since the last frame.
struct ControlInput {
  double seconds = 0;  ///< since the last call; longer than 0.1 s counts as 0.1 s, so that a hitch is no leap
  glm::dvec2 cursorPixels{0.0}, cursorMovePixels{0.0};
  bool primaryButton = false, secondaryButton = false;
  double wheelSteps = 0;   ///< away from the person is positive: nearer to the ground
  glm::dvec3 move{0.0};    ///< right, up, forward, each -1..1
  double speedFactor = 1;  ///< 4 with the fast key, 0.25 with the slow one
};

/// The picture that the cursor moves over.
struct ControlView {
  double radiusMeters = 0;
  double verticalFieldOfView = 0.9;
  int widthPixels = 1280, heightPixels = 720;
  /// Of the bodies that can be flown to, if larger than this one: how high and how fast one may fly.
  double largestRadiusMeters = 0;
};

/// Height of the ground under a unit direction, metres above the reference sphere; empty where nothing is known yet.
using GroundHeight = std::function<std::optional<double>(const glm::dvec3&)>;

class CameraControls {
 public:
  explicit CameraControls(const ViewPose& home) : home_(home), pose_(home) {}

  /// One frame. The result is finite, at least kLowestHeightAboveGroundMeters above known ground and at most 60 of
  /// the largest radii high.
  ViewPose advance(const ControlInput& input, const ControlView& view, const GroundHeight& ground);

  const ViewPose& pose() const noexcept { return pose_; }
  /// Jumps, and stops all motion.
  void setPose(const ViewPose& pose);
  /// The same place and view as a pose over another body has them. Flight goes on; what turned about the old body ends,
  /// and the picture rolls level with the new one.
  void moveOver(const ViewPose& pose);
  void setHome(const ViewPose& home) { home_ = home; }
  void goHome() { setPose(home_); }
  ControlMode mode() const noexcept { return mode_; }
  void toggleMode();

  /// True while the camera goes on moving without further input: frames must be drawn.
  bool moving() const noexcept;
  double speedMetersPerSecond() const noexcept { return speedMetersPerSecond_; }

 private:
  void drag(const ControlInput& input, const ControlView& view, double heightAboveGround, double groundMeters);
  void spinOn(double seconds, double radiusMeters, double heightAboveGround);
  void look(const glm::dvec2& movePixels, const ControlView& view);
  void zoom(double seconds, double groundMeters);
  void fly(const ControlInput& input, const ControlView& view, double seconds, double heightAboveGround);
  void rotateAboutCentre(const glm::dvec3& axis, double angle);
  void level(double seconds) noexcept;
  void stop() noexcept;

  ViewPose home_, pose_;
  ControlMode mode_ = ControlMode::Orbit;
  double pendingZoom_ = 0;         ///< natural logarithm of the height factor still to be applied
  glm::dvec3 spinPerSecond_{0.0};  ///< rotation vector of the camera about the body's centre, radians a second
  glm::dvec3 velocity_{0.0};       ///< right, up, forward, in units of the free speed
  double speedMetersPerSecond_ = 0;
};

/// Unit vector of a longitude and latitude, body frame.
glm::dvec3 directionOf(double longitude, double latitude) noexcept;

/// The speed of free flight at a height above ground: proportional to it, between a walk and half a radius a second.
double freeSpeedMetersPerSecond(double heightAboveGroundMeters, double radiusMeters) noexcept;

}  // namespace terrane

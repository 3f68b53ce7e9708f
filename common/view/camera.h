#pragma once
// A camera over a body, in double, body frame (+Z north pole, +X longitude 0, east positive, right-handed, metres).
// Heading runs from north clockwise, pitch 0 is level and -90 degrees straight down; radians in here, degrees at the
// command line. Values are plain data; functions are thread-safe.

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace terrane {

struct Camera {
  glm::dvec3 positionBody{0.0};
  /// Height above the reference sphere, kept as a quantity of its own: |position| - R cancels.
  double altitudeMeters = 0;
  /// Rows are right, up, backward (the camera looks along -backward), orthonormal to 1e-15.
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, backward{0, 0, 1};
  double verticalFieldOfView = 0.9;  ///< radians
  int widthPixels = 1280;
  int heightPixels = 720;
  double nearMeters = 0.01;  ///< the one near plane: there is no far plane
};

/// Where a viewer stands, as it is written at the command line: longitude and latitude radians, altitude metres.
struct ViewPose {
  double longitude = 0, latitude = 0;
  double altitudeMeters = 0;
  double heading = 0, pitch = 0;
  double roll = 0;  ///< of the picture's right side, down; not 0 only after a change of body, whose level is another
};

/// Every finite pose gives a finite orthonormal camera, at the poles too (heading then counts from the meridian's
/// direction).
Camera cameraFromPose(const ViewPose& pose, double radiusMeters, double verticalFieldOfView, int widthPixels,
                      int heightPixels) noexcept;
/// The inverse, with a roll of 0 where it is less than rounding (2^-48). At a pitch of +-90 degrees the heading is
/// taken from the up vector.
ViewPose poseFromCamera(const Camera& camera) noexcept;

/// The same camera with a picture wider and higher by this share of it on every side, and pixels as large as before.
Camera widened(const Camera& camera, double share) noexcept;
/// A viewer asks for what lies beside the picture too: a tile that is late when it comes into view can only be drawn
/// coarser than those beside it, and takes them with it.
inline constexpr double kShareAhead = 0.25;

/// World-to-camera rotation (no translation: positions come camera-relative).
glm::dmat3 viewRotation(const Camera& camera) noexcept;
/// Reversed depth, infinite far plane: clip z = near, w = distance, so depth is 1 at the near plane and 0 at infinity.
/// For glClipControl(GL_ZERO_TO_ONE).
glm::dmat4 reversedInfiniteProjection(const Camera& camera) noexcept;
/// Pixels that one metre covers at a distance of one metre.
double pixelsPerRadian(const Camera& camera) noexcept;

}  // namespace terrane

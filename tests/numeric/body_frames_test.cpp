// One camera over several bodies: where it is in another body's frame is as exact as the header says, against MPFR,
// however far from the scene's origin both lie; and to look from another body's frame moves nothing in the picture.
#include "common/view/body_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "common/scene/scene.h"
#include "tests/support/high_precision.h"

namespace terrane {
namespace {

using test::HighPrecision;

constexpr unsigned kSeed = 20270114;
constexpr double kRadiusMeters = 1737400, kFieldOfView = 0.87;

class Places {
 public:
  double between(double low, double high) { return low + (high - low) * unit_(random_); }
  /// Of a magnitude between the two, evenly in its logarithm.
  double magnitude(double low, double high) { return low * std::pow(high / low, unit_(random_)); }
  glm::dvec3 direction() {
    const double z = between(-1, 1), angle = between(-3.14159, 3.14159), flat = std::sqrt(1 - z * z);
    return {flat * std::cos(angle), flat * std::sin(angle), z};
  }
  ViewPose pose() {
    return {between(-3.1, 3.1), between(-1.5, 1.5), magnitude(1, 1e9), between(-3.1, 3.1), between(-1.5, 1.5)};
  }

 private:
  std::mt19937_64 random_{kSeed};
  std::uniform_real_distribution<double> unit_{0, 1};
};

Camera cameraOver(const ViewPose& pose, double radiusMeters) {
  return cameraFromPose(pose, radiusMeters, kFieldOfView, 1280, 720);
}

/// Where in the picture a point of the body's frame is, pixels from its middle.
glm::dvec2 pixelOf(const Camera& camera, const glm::dvec3& pointBody) {
  const glm::dvec3 seen = viewRotation(camera) * (pointBody - camera.positionBody);
  return pixelsPerRadian(camera) / -seen.z * glm::dvec2(seen.x, seen.y);
}

TEST(BodyFrames, TheCameraOverAnotherBodyIsOffByItsBoundAtMost) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Places places;
  double worst = 0, worstAltitude = 0, throughTheOrigin = 0;
  for (int i = 0; i < 20'000; ++i) {
    const glm::dvec3 from = places.magnitude(1, kMaxPositionMeters) * places.direction();
    const glm::dvec3 to = from + places.magnitude(1e3, 1e10) * places.direction();
    const Camera camera = cameraOver(places.pose(), kRadiusMeters);
    const Camera over = cameraOverOther(camera, from, to, kRadiusMeters);
    HighPrecision squared = 0;
    double bound = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const HighPrecision truly = HighPrecision(camera.positionBody[axis]) + (HighPrecision(from[axis]) - to[axis]);
      squared += truly * truly;
      const double allowed = 0x1p-53 * 1.0001 * (std::abs(from[axis] - to[axis]) + std::abs(over.positionBody[axis]));
      const auto error = [&](double position) {
        return std::abs(static_cast<double>(HighPrecision(HighPrecision(position) - truly)));
      };
      if (allowed > 0) worst = std::max(worst, error(over.positionBody[axis]) / allowed);
      if (allowed > 0)
        throughTheOrigin =
            std::max(throughTheOrigin, error((camera.positionBody[axis] + from[axis]) - to[axis]) / allowed);
      bound += allowed;
    }
    const HighPrecision altitude = sqrt(squared) - kRadiusMeters;
    const double distance = static_cast<double>(HighPrecision(sqrt(squared)));
    worstAltitude = std::max(
        worstAltitude, std::abs(static_cast<double>(HighPrecision(HighPrecision(over.altitudeMeters) - altitude))) /
                           (bound + 0x1p-51 * distance));
  }
  EXPECT_LE(worst, 1);
  EXPECT_LE(worstAltitude, 1);
  EXPECT_GT(throughTheOrigin, 100) << "the control, by way of the scene's origin, should be far off";
}

// What a change of anchor does: the camera over another body, written as a pose over it and made a camera again.
TEST(BodyFrames, APoseOverAnotherBodyGivesTheSamePicture) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Places places;
  double worstPixels = 0, greatestRoll = 0;
  int seen = 0;
  for (int i = 0; i < 20'000; ++i) {
    const glm::dvec3 from = places.magnitude(1, kMaxPositionMeters) * places.direction();
    const double otherRadius = places.magnitude(500, 6e6);
    const Camera camera = cameraOver(places.pose(), kRadiusMeters);
    // The other body is about as far as this one, as where an anchor changes.
    const double away = otherRadius + places.between(0.5, 1.0) * std::max(camera.altitudeMeters, 10.0);
    const glm::dvec3 to = from + camera.positionBody + away * places.direction();
    const Camera over = cameraOverOther(camera, from, to, otherRadius);
    const ViewPose pose = poseFromCamera(over);
    const Camera again = cameraOver(pose, otherRadius);
    greatestRoll = std::max(greatestRoll, std::abs(pose.roll));
    // A point of the old body's surface that is in the picture.
    const glm::dvec3 point =
        kRadiusMeters * glm::normalize(camera.positionBody + 0.3 * camera.altitudeMeters * places.direction());
    const glm::dvec2 before = pixelOf(camera, point);
    if (!(glm::dot(point - camera.positionBody, camera.backward) < 0) || std::abs(before.x) > 640 ||
        std::abs(before.y) > 360)
      continue;
    ++seen;
    worstPixels = std::max(worstPixels, glm::length(before - pixelOf(again, point + (from - to))));
  }
  EXPECT_GT(seen, 1000);
  EXPECT_LT(worstPixels, 1e-3);
  EXPECT_GT(greatestRoll, 1) << "without a roll the picture would turn";
}

TEST(BodyFrames, BodiesInOnePlaceHaveOneCamera) {
  const Camera camera = cameraOver({0.3, 0.4, 1234.5, 0.6, -0.7}, kRadiusMeters);
  const glm::dvec3 place(1e12, -3e11, 7);
  const Camera over = cameraOverOther(camera, place, place, kRadiusMeters);
  EXPECT_EQ(over.positionBody, camera.positionBody);
  EXPECT_NEAR(over.altitudeMeters, camera.altitudeMeters, 0x1p-51 * kRadiusMeters);
}

TEST(BodyFrames, ADiscIsAsWideAsItsTangentsAreApart) {
  Camera camera = cameraOver({0, 0, 0, 0, 0}, kRadiusMeters);
  camera.positionBody = {2 * kRadiusMeters, 0, 0};
  EXPECT_NEAR(diameterPixels(camera, kRadiusMeters), 2 * pixelsPerRadian(camera) / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(diameterPixels(camera, 3 * kRadiusMeters), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace terrane

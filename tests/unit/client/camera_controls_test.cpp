#include "client/controls/camera_controls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace terrane {
namespace {

constexpr double kRadius = 1'737'400;
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFrame = 1.0 / 60;

ControlView moonView() { return {kRadius, 0.9, 1280, 720}; }
std::optional<double> flatGround(const glm::dvec3&) { return 0.0; }
std::optional<double> unknownGround(const glm::dvec3&) { return std::nullopt; }

Camera cameraOf(const ViewPose& pose) { return cameraFromPose(pose, kRadius, 0.9, 1280, 720); }

// Where the ray through a pixel meets the reference sphere; the test's own arithmetic, on long double.
glm::dvec3 hit(const ViewPose& pose, const glm::dvec2& pixel) {
  const Camera camera = cameraOf(pose);
  const double tangent = std::tan(0.45);
  const glm::dvec3 ray = glm::normalize(camera.right * ((2 * pixel.x / 1280 - 1) * tangent * 1280 / 720) +
                                        camera.up * ((1 - 2 * pixel.y / 720) * tangent) - camera.backward);
  const long double b = glm::dot(camera.positionBody, ray);
  const long double c = static_cast<long double>(pose.altitudeMeters) * (2 * kRadius + pose.altitudeMeters);
  const long double root = b * b - c;
  if (root < 0) return glm::dvec3(std::nan(""));
  return glm::normalize(camera.positionBody + ray * static_cast<double>(-b - std::sqrt(root)));
}

ControlInput dragTo(const glm::dvec2& from, const glm::dvec2& to) {
  ControlInput input;
  input.seconds = kFrame;
  input.cursorPixels = to;
  input.cursorMovePixels = to - from;
  input.primaryButton = true;
  return input;
}

TEST(CameraControls, ADraggedPointStaysUnderTheCursorFromOrbitToTheGround) {
  for (const double altitude : {8e6, 1e6, 2e4, 300.0, 2.0}) {
    for (const double pitch : {-90.0, altitude > 1e5 ? -86.0 : -55.0}) {
      CameraControls controls(ViewPose{0.7, -0.4, altitude, 0.3, pitch * kDegree});
      const glm::dvec2 from{600, 400}, to{655, 350};
      const glm::dvec3 grabbed = hit(controls.pose(), from);
      controls.advance(dragTo(from, to), moonView(), flatGround);
      const glm::dvec3 now = hit(controls.pose(), to);
      const double pixelMeters = altitude * 0.9 / 720;
      EXPECT_LT(glm::length(now - grabbed) * kRadius, 0.01 * pixelMeters + 1e-8) << altitude << " m, pitch " << pitch;
      EXPECT_EQ(controls.pose().altitudeMeters, altitude);
    }
  }
}

TEST(CameraControls, ADragAtThePoleIsAsGoodAsAnyOther) {
  CameraControls controls(ViewPose{0.2, std::numbers::pi / 2 - 1e-3, 1e6, 0.0, -90 * kDegree});
  glm::dvec2 from{640, 300};
  for (int i = 0; i < 40; ++i) {
    const glm::dvec2 to = from + glm::dvec2{3, 9};
    const glm::dvec3 grabbed = hit(controls.pose(), from);
    controls.advance(dragTo(from, to), moonView(), flatGround);
    ASSERT_LT(glm::length(hit(controls.pose(), to) - grabbed), 1e-6) << i;
    from = to - glm::dvec2{3, 9};  // grab again at the same place
  }
}

TEST(CameraControls, AWheelStepChangesTheHeightAboveGroundByOneFactorAtEveryHeight) {
  const auto ground = [](const glm::dvec3&) { return std::optional<double>(-1500.0); };
  for (const double height : {5e6, 1e3, 3.0}) {
    CameraControls controls(ViewPose{0, 0, height - 1500, 0, -1});
    ControlInput input;
    input.seconds = kFrame;
    input.wheelSteps = 1;
    controls.advance(input, moonView(), ground);
    input.wheelSteps = 0;
    EXPECT_TRUE(controls.moving());
    for (int i = 0; i < 120; ++i) controls.advance(input, moonView(), ground);
    EXPECT_FALSE(controls.moving());
    EXPECT_NEAR((controls.pose().altitudeMeters + 1500) / height, std::exp(-0.22), 1e-6) << height;
  }
}

TEST(CameraControls, ZoomDoesNotDependOnTheFrameRate) {
  const auto altitudeAfter = [](double seconds, int frames) {
    CameraControls controls(ViewPose{0, 0, 1e5, 0, -1});
    ControlInput input;
    input.wheelSteps = 5;
    for (int i = 0; i < frames; ++i) {
      input.seconds = seconds;
      controls.advance(input, moonView(), flatGround);
      input.wheelSteps = 0;
    }
    return controls.pose().altitudeMeters;
  };
  EXPECT_NEAR(altitudeAfter(1.0 / 20, 4) / altitudeAfter(1.0 / 240, 48), 1, 1e-9);
}

TEST(CameraControls, NothingBringsTheCameraBelowTheGround) {
  constexpr std::uint64_t kSeed = 41;
  std::mt19937_64 random(kSeed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto hills = [](const glm::dvec3& d) {
    return std::optional<double>(900 * std::sin(4000 * d.x) * std::sin(3000 * d.y + 1) + 200 * std::sin(90000 * d.z));
  };
  CameraControls controls(ViewPose{0.3, 0.2, 5000, 0, -1});
  for (int i = 0; i < 20'000; ++i) {
    ControlInput input;
    input.seconds = 0.1 * unit();
    input.cursorPixels = {1280 * unit(), 720 * unit()};
    input.cursorMovePixels = {60 * unit() - 30, 60 * unit() - 30};
    input.primaryButton = unit() < 0.3;
    input.secondaryButton = unit() < 0.2;
    input.wheelSteps = unit() < 0.2 ? 4 * unit() - 1.5 : 0;
    input.move = {2 * unit() - 1, 2 * unit() - 1.4, 2 * unit() - 1};
    input.speedFactor = unit() < 0.3 ? 4 : 1;
    if (unit() < 0.01) controls.toggleMode();
    const ViewPose pose = controls.advance(input, moonView(), hills);
    for (const double value : {pose.longitude, pose.latitude, pose.altitudeMeters, pose.heading, pose.pitch})
      ASSERT_TRUE(std::isfinite(value)) << "seed " << kSeed << ", step " << i;
    ASSERT_GE(pose.altitudeMeters,
              *hills(directionOf(pose.longitude, pose.latitude)) + kLowestHeightAboveGroundMeters - 1e-9)
        << "seed " << kSeed << ", step " << i;
    ASSERT_LE(pose.altitudeMeters, 60 * kRadius);
    ASSERT_LE(std::abs(pose.pitch), 90 * kDegree);
  }
}

TEST(CameraControls, UnknownGroundDoesNotMoveACameraInADeepCrater) {
  CameraControls controls(ViewPose{0, 0, -3000, 0, 0});
  ControlInput input;
  input.seconds = kFrame;
  EXPECT_EQ(controls.advance(input, moonView(), unknownGround).altitudeMeters, -3000);
}

TEST(CameraControls, FlyingForwardLevelKeepsTheAltitudeAndGoesWhereTheHeadingPoints) {
  CameraControls controls(ViewPose{0.1, 0, 1000, 90 * kDegree, 0});
  controls.toggleMode();
  ControlInput input;
  input.seconds = kFrame;
  input.move = {0, 0, 1};
  for (int i = 0; i < 600; ++i) controls.advance(input, moonView(), flatGround);
  EXPECT_DOUBLE_EQ(controls.pose().altitudeMeters, 1000);
  EXPECT_NEAR(controls.pose().latitude, 0, 1e-12);
  // Ten seconds at 0.8 heights a second, less the start of 0.18 s.
  EXPECT_NEAR((controls.pose().longitude - 0.1) * (kRadius + 1000), 0.8 * 1000 * (10 - 0.18), 20);
}

TEST(CameraControls, OnceAroundAlongAGreatCircleComesBackToThePlaceAndTheHeading) {
  CameraControls controls(ViewPose{0.1, 0.5, 4 * kRadius, 60 * kDegree, 0});
  controls.toggleMode();
  ControlInput input;
  input.seconds = 0.05;
  input.move = {0, 0, 1};
  const glm::dvec3 start = directionOf(0.1, 0.5);
  double nearest = 10, headingThere = 0;
  for (int i = 0; i < 3000; ++i) {
    controls.advance(input, moonView(), flatGround);
    const double away = glm::length(directionOf(controls.pose().longitude, controls.pose().latitude) - start);
    if (i > 200 && away < nearest) {
      nearest = away;
      headingThere = controls.pose().heading;
    }
  }
  EXPECT_LT(nearest, 0.01);
  EXPECT_NEAR(headingThere, 60 * kDegree, 0.02);
}

TEST(CameraControls, SpeedFollowsTheHeightAboveGroundNotAboveTheSphere) {
  const auto highlands = [](const glm::dvec3&) { return std::optional<double>(5000.0); };
  const auto speedAt = [&](double height) {
    CameraControls controls(ViewPose{0, 0, 5000 + height, 0, 0});
    controls.toggleMode();
    ControlInput input;
    input.seconds = kFrame;
    input.move = {0, 0, 1};
    for (int i = 0; i < 200; ++i) controls.advance(input, moonView(), highlands);
    return controls.speedMetersPerSecond();
  };
  EXPECT_NEAR(speedAt(100) / speedAt(10), 10, 0.05);
  EXPECT_NEAR(speedAt(10), 8, 0.05);
}

TEST(CameraControls, ReleasedHandsEndAllMotionSoonSoThatAnIdleViewerSleeps) {
  CameraControls controls(ViewPose{0, 0, 1e6, 0, -1});
  glm::dvec2 cursor{640, 360};
  for (int i = 0; i < 5; ++i) {
    controls.advance(dragTo(cursor, cursor + glm::dvec2{20, 0}), moonView(), flatGround);
    cursor += glm::dvec2{20, 0};
  }
  ControlInput rest;
  rest.seconds = kFrame;
  controls.advance(rest, moonView(), flatGround);
  EXPECT_TRUE(controls.moving()) << "a thrown body spins on";
  for (int i = 0; i < 300; ++i) controls.advance(rest, moonView(), flatGround);
  EXPECT_FALSE(controls.moving());
  const ViewPose still = controls.pose();
  controls.advance(rest, moonView(), flatGround);
  EXPECT_EQ(controls.pose().longitude, still.longitude);
}

TEST(CameraControls, ABodyHeldStillBeforeItIsReleasedIsNotThrown) {
  CameraControls controls(ViewPose{0, 0, 1e6, 0, -1});
  controls.advance(dragTo({600, 300}, {640, 300}), moonView(), flatGround);
  controls.advance(dragTo({640, 300}, {640, 300}), moonView(), flatGround);
  ControlInput rest;
  rest.seconds = kFrame;
  controls.advance(rest, moonView(), flatGround);
  EXPECT_FALSE(controls.moving());
}

// Where another body becomes the one that poses are over, its level is another too.
TEST(CameraControls, OverAnotherBodyFlightGoesOnAndThePictureRollsLevelSlowly) {
  CameraControls controls(ViewPose{0, 0, 1e6, 0, -0.2});
  controls.toggleMode();
  ControlInput ahead;
  ahead.seconds = kFrame;
  ahead.move = {0, 0, 1};
  for (int i = 0; i < 100; ++i) controls.advance(ahead, moonView(), flatGround);
  const double speedBefore = controls.speedMetersPerSecond();
  ViewPose over = controls.pose();
  over.roll = 1.2;
  controls.moveOver(over);
  controls.advance(ahead, moonView(), flatGround);
  EXPECT_NEAR(controls.speedMetersPerSecond(), speedBefore, 0.05 * speedBefore);
  EXPECT_NEAR(controls.pose().roll, 1.2, 0.1) << "one frame turns the picture by a few degrees";
  ControlInput rest;
  rest.seconds = kFrame;
  for (int i = 0; i < 100; ++i) controls.advance(rest, moonView(), flatGround);
  EXPECT_TRUE(controls.moving()) << "still rolling";
  for (int i = 0; i < 600; ++i) controls.advance(rest, moonView(), flatGround);
  EXPECT_EQ(controls.pose().roll, 0);
  EXPECT_FALSE(controls.moving());
}

TEST(CameraControls, HomeBringsBackTheFirstPose) {
  const ViewPose home{0.4, 0.3, 2e6, 0.1, -1.2};
  CameraControls controls(home);
  controls.advance(dragTo({600, 300}, {700, 350}), moonView(), flatGround);
  controls.goHome();
  EXPECT_EQ(controls.pose().longitude, home.longitude);
  EXPECT_EQ(controls.pose().pitch, home.pitch);
  EXPECT_FALSE(controls.moving());
}

}  // namespace
}  // namespace terrane

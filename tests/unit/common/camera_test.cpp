#include "common/view/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace terrane {
namespace {

constexpr double kMoon = 1'737'400.0;
constexpr double kPi = std::numbers::pi;
constexpr double kField = 0.9;
constexpr unsigned kSeed = 20261122;

Camera moonCamera(const ViewPose& pose) { return cameraFromPose(pose, kMoon, kField, 1280, 720); }

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_NEAR(glm::length(a - b), 0.0, tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

void expectOrthonormal(const Camera& camera) {
  EXPECT_NEAR(glm::dot(camera.right, camera.right), 1.0, 1e-15);
  EXPECT_NEAR(glm::dot(camera.up, camera.up), 1.0, 1e-15);
  EXPECT_NEAR(glm::dot(camera.backward, camera.backward), 1.0, 1e-15);
  EXPECT_NEAR(glm::dot(camera.right, camera.up), 0.0, 1e-15);
  EXPECT_NEAR(glm::dot(camera.up, camera.backward), 0.0, 1e-15);
  EXPECT_NEAR(glm::dot(camera.backward, camera.right), 0.0, 1e-15);
  EXPECT_GT(glm::dot(glm::cross(camera.right, camera.up), camera.backward), 0.9);
}

TEST(Camera, HeadingRunsFromNorthClockwise) {
  const Camera north = moonCamera({0, 0, 100, 0, 0});
  expectNear(north.positionBody, {kMoon + 100, 0, 0}, 1e-9);
  expectNear(-north.backward, {0, 0, 1}, 1e-15);
  expectNear(north.right, {0, 1, 0}, 1e-15);
  expectNear(north.up, {1, 0, 0}, 1e-15);
  const Camera east = moonCamera({0, 0, 100, kPi / 2, 0});
  expectNear(-east.backward, {0, 1, 0}, 1e-15);
  expectNear(east.right, {0, 0, -1}, 1e-15);
}

TEST(Camera, PitchMinusNinetyLooksAtTheCentreWithItsHeadingUpwards) {
  const Camera down = moonCamera({0, 0, 100, kPi / 2, -kPi / 2});
  expectNear(-down.backward, {-1, 0, 0}, 1e-15);
  expectNear(down.up, {0, 1, 0}, 1e-15);
}

TEST(Camera, IsOrthonormalForEveryPose) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  std::uniform_real_distribution<double> turn(-2 * kPi, 2 * kPi);
  const double special[] = {0.0, kPi / 2, -kPi / 2, kPi, -kPi, 1e-9, std::nextafter(kPi / 2, 0.0)};
  for (int i = 0; i < 2000; ++i) {
    ViewPose pose{turn(random), turn(random) / 4, 10.0, turn(random), turn(random) / 4};
    if (i % 3 == 0) pose.latitude = special[i % 7];
    if (i % 5 == 0) pose.pitch = special[i % 7];
    expectOrthonormal(moonCamera(pose));
  }
}

TEST(Camera, ReadsItsPoseBack) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const double poles[] = {kPi / 2, -kPi / 2, unit(random) * kPi / 2, unit(random) * kPi / 2};
    const double pitches[] = {-kPi / 2, kPi / 2, 0.0, unit(random) * kPi / 2, unit(random) * kPi / 2};
    const ViewPose pose{unit(random) * kPi, poles[i % 4], std::pow(10.0, 4 * unit(random) + 3), unit(random) * kPi,
                        pitches[i % 5]};
    const ViewPose read = poseFromCamera(moonCamera(pose));
    EXPECT_NEAR(read.longitude, pose.longitude, 1e-12);
    EXPECT_NEAR(read.latitude, pose.latitude, 1e-12);
    EXPECT_EQ(read.altitudeMeters, pose.altitudeMeters);
    EXPECT_NEAR(std::remainder(read.heading - pose.heading, 2 * kPi), 0.0, 1e-9);
    EXPECT_NEAR(read.pitch, pose.pitch, 1e-9);
  }
}

TEST(Camera, AtAPoleHeadingCountsFromTheMeridian) {
  const Camera camera = moonCamera({kPi / 3, kPi / 2, 100, 0, 0});
  // Northwards along the meridian of 60 degrees, over the pole.
  expectNear(-camera.backward, {-std::cos(kPi / 3), -std::sin(kPi / 3), 0}, 1e-15);
}

TEST(Camera, AtTheCentreOfThePlanetIsStillACamera) {
  const Camera camera = moonCamera({1, 0.5, -kMoon, 2, -0.3});
  expectNear(camera.positionBody, glm::dvec3(0.0), 0);
  expectOrthonormal(camera);
  const ViewPose read = poseFromCamera(camera);
  EXPECT_TRUE(std::isfinite(read.longitude) && std::isfinite(read.latitude) && std::isfinite(read.heading) &&
              std::isfinite(read.pitch));
  EXPECT_EQ(read.altitudeMeters, -kMoon);
}

TEST(Camera, KeepsAMillimetreOfAltitudeThatThePositionHasLost) {
  const double earth = 6'371'000.0;
  const Camera camera = cameraFromPose({0.3, 0.2, 1e-9, 0, 0}, earth, kField, 1280, 720);
  EXPECT_EQ(camera.altitudeMeters, 1e-9);
  EXPECT_NE(glm::length(camera.positionBody) - earth, 1e-9);  // the control: what subtracting would give
}

TEST(Camera, ViewRotationTakesWhatIsAheadToMinusZ) {
  const Camera camera = moonCamera({0.4, -0.3, 500, 1.1, -0.7});
  const glm::dmat3 view = viewRotation(camera);
  expectNear(view * -camera.backward, {0, 0, -1}, 1e-15);
  expectNear(view * camera.right, {1, 0, 0}, 1e-15);
  expectNear(view * camera.up, {0, 1, 0}, 1e-15);
}

TEST(Camera, DepthIsOneAtTheNearPlaneAndFallsToZeroAtInfinity) {
  Camera camera = moonCamera({});
  camera.nearMeters = 0.05;
  const glm::dmat4 projection = reversedInfiniteProjection(camera);
  const auto depthAt = [&](double distance) {
    const glm::dvec4 clip = projection * glm::dvec4(0, 0, -distance, 1);
    return clip.z / clip.w;
  };
  EXPECT_DOUBLE_EQ(depthAt(0.05), 1.0);
  EXPECT_DOUBLE_EQ(depthAt(0.1), 0.5);
  EXPECT_GT(depthAt(1e7), 0.0);
  EXPECT_LT(depthAt(1e12), 1e-12);
}

TEST(Camera, FieldOfViewEndsAtTheEdgeOfThePicture) {
  const Camera camera = moonCamera({});
  const glm::dmat4 projection = reversedInfiniteProjection(camera);
  const double top = std::tan(kField / 2);
  const glm::dvec4 clip = projection * glm::dvec4(top * 1280 / 720, top, -1, 1);
  EXPECT_NEAR(clip.x / clip.w, 1.0, 1e-15);
  EXPECT_NEAR(clip.y / clip.w, 1.0, 1e-15);
  EXPECT_NEAR(pixelsPerRadian(camera) * top, 360.0, 1e-10);
}

TEST(Camera, WidenedItSeesFurtherOnEverySideWithPixelsAsLargeAsBefore) {
  const Camera camera = cameraFromPose({0.3, -0.4, 1e5, 1, -0.5}, 1737400, 0.9, 1281, 719);
  const Camera wide = widened(camera, 0.25);
  EXPECT_NEAR(pixelsPerRadian(wide) / pixelsPerRadian(camera), 1, 1e-14);
  EXPECT_EQ(wide.widthPixels, 1281 + 2 * 321);
  EXPECT_EQ(wide.heightPixels, 719 + 2 * 180);
  EXPECT_EQ(wide.positionBody, camera.positionBody);
  EXPECT_EQ(wide.backward, camera.backward);
}

}  // namespace
}  // namespace terrane

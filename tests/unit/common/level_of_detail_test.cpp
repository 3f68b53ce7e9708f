#include "common/view/level_of_detail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

namespace terrane {
namespace {

constexpr double kRadians = 0.017453292519943295;

OrientedBox box(double halfWidth, double halfHeight) {
  return {{10, 20, 30}, {glm::dvec3(halfWidth, 0, 0), glm::dvec3(0, halfWidth, 0), glm::dvec3(0, 0, halfHeight)}};
}

Camera cameraAt(const glm::dvec3& position) {
  Camera camera;
  camera.positionBody = position;
  camera.verticalFieldOfView = 2 * std::atan(0.5);  // pixelsPerRadian = heightPixels
  camera.heightPixels = 1000;
  return camera;
}

TEST(LevelOfDetail, DistanceIsThatOfTheNearestPoint) {
  EXPECT_EQ(distanceMeters(box(4, 1), {10, 20, 30}), 0.0);
  EXPECT_EQ(distanceMeters(box(4, 1), {14, 16, 31}), 0.0);
  EXPECT_EQ(distanceMeters(box(4, 1), {10, 20, 36}), 5.0);
  EXPECT_EQ(distanceMeters(box(4, 1), {17, 24, 35}), 5.0);  // beside an edge: 3 and 4
}

TEST(LevelOfDetail, FaceOnTheErrorIsItsAngleInPixels) {
  EXPECT_DOUBLE_EQ(screenSpaceErrorPixels(0.5, box(4, 1), cameraAt({10, 20, 131})), 0.5 * 1000 / 100);
}

TEST(LevelOfDetail, InsideTheBoxTheErrorIsInfinite) {
  EXPECT_EQ(screenSpaceErrorPixels(0.5, box(4, 1), cameraAt({10, 20, 30})), std::numeric_limits<double>::infinity());
  EXPECT_EQ(foreshortening(box(4, 1), {10, 20, 30}), 1.0);
}

TEST(LevelOfDetail, FlatGroundIsForeshortenedByItsAreaInThePicture) {
  for (const double degrees : {15.0, 30.0, 60.0, 89.0}) {
    // In line with an edge, so that the nearest point is on it, at this angle.
    const double distance = 50;
    const glm::dvec3 position{14 + distance * std::cos(degrees * kRadians), 20,
                              30 + distance * std::sin(degrees * kRadians)};
    EXPECT_NEAR(foreshortening(box(4, 0), position), std::sqrt(std::sin(degrees * kRadians)), 1e-12) << degrees;
  }
  EXPECT_EQ(foreshortening(box(4, 0), {1000, 20, 30.001}), kLeastForeshortening);
}

TEST(LevelOfDetail, ThickBoxesKeepTheirDetailAtGrazingAngles) {
  const glm::dvec3 level{1000, 20, 30};
  EXPECT_NEAR(foreshortening(box(4, 2), level), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(foreshortening(box(4, 8), level), 1.0);
}

TEST(LevelOfDetail, ChangesSteadilyAsTheCameraMoves) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const OrientedBox subject = box(4, 0.7);
  for (int i = 0; i < 20'000; ++i) {
    const glm::dvec3 position = subject.center + glm::dvec3(40 * unit(random), 40 * unit(random), 20 * unit(random));
    const double distance = distanceMeters(subject, position);
    if (distance < 0.5) continue;
    const glm::dvec3 moved = position + 1e-6 * glm::dvec3(unit(random), unit(random), unit(random));
    EXPECT_NEAR(foreshortening(subject, position), foreshortening(subject, moved), 2e-5);
  }
}

TEST(LevelOfDetail, PlacesThatAreNoNumbersGiveNoNumberBelowTheLeast) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GE(foreshortening(box(4, 1), {nan, nan, nan}), kLeastForeshortening);
  EXPECT_GE(foreshortening(box(0, 0), {1, 2, 3}), kLeastForeshortening);
}

}  // namespace
}  // namespace terrane

#include "common/view/horizon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

namespace terrane {
namespace {

constexpr double kEarth = 6'371'000.0;
constexpr unsigned kSeed = 45;

TEST(Horizon, IsWhereItShouldBeFromOneMetreAndFromOneMillimetre) {
  EXPECT_NEAR(horizonDistanceMeters(kEarth, 1.0), 3569.594, 0.001);
  EXPECT_NEAR(horizonDistanceMeters(kEarth, 1e-3), 112.880, 0.001);
  // The control: the textbook formula in float is 22 m short from one metre, and sees no horizon at all from a
  // millimetre.
  const auto textbook = [](float radius, float height) {
    const float distance = radius + height;
    return std::sqrt(distance * distance - radius * radius);
  };
  EXPECT_GT(std::abs(textbook(6'371'000.0f, 1.0f) - 3569.594f), 20.0f);
  EXPECT_EQ(textbook(6'371'000.0f, 1e-3f), 0.0f);
}

TEST(Horizon, DistanceIsWithinFourRoundingsFromAMicrometreUp) {
  for (double height = 1e-6; height < 1e12; height *= 3.7) {
    const long double h = height, r = kEarth;
    const long double exact = std::sqrt(h * (2 * r + h));
    EXPECT_LE(std::abs(static_cast<long double>(horizonDistanceMeters(kEarth, height)) - exact), 4 * 1.11e-16L * exact)
        << height;
  }
  EXPECT_EQ(horizonDistanceMeters(kEarth, 0), 0);
  EXPECT_EQ(horizonDistanceMeters(kEarth, -5), 0);
  EXPECT_EQ(horizonDistanceMeters(kEarth, std::numeric_limits<double>::quiet_NaN()), 0);
}

/// Does the segment between the two points cross the sphere? In extended precision, by its nearest point to the centre.
bool sphereBetween(const glm::dvec3& from, const glm::dvec3& to, double radius) {
  using Wide = glm::tvec3<long double>;
  const Wide a(from), d = Wide(to) - a;
  const long double t = -glm::dot(a, d) / glm::dot(d, d);
  if (t <= 0 || t >= 1) return false;
  const Wide nearest = a + d * t;
  return glm::dot(nearest, nearest) < static_cast<long double>(radius) * radius;
}

TEST(Horizon, HidesExactlyWhatTheSphereStandsBefore) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
  int hidden = 0, undecided = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double altitude = std::pow(10.0, 9 * unit(random) - 2), lowest = kEarth - 1000 * unit(random);
    const glm::dvec3 camera = direction() * (kEarth + altitude);
    // Half of the points lie near the horizon circle, where the test can go wrong.
    const double reach = 2 * horizonDistanceMeters(lowest, altitude) / kEarth;
    const glm::dvec3 around =
        i % 2 == 0 ? direction() : glm::normalize(glm::normalize(camera) + direction() * std::min(reach, 3.0));
    const glm::dvec3 point = around * (lowest * (1 + 0.01 * unit(random) * unit(random)));
    const Horizon horizon(camera, kEarth, altitude, lowest);
    ASSERT_TRUE(horizon.active());
    const bool surelyHidden = sphereBetween(camera, point, lowest * (1 - 1e-12));
    const bool surelySeen = !sphereBetween(camera, point, lowest * (1 + 1e-12));
    if (surelyHidden || surelySeen) {
      EXPECT_EQ(horizon.hides(point), surelyHidden) << i;
    }
    hidden += surelyHidden;
    undecided += !surelyHidden && !surelySeen;
  }
  EXPECT_GT(hidden, 5000);
  EXPECT_LT(undecided, 20);
}

TEST(Horizon, StandsWhereItShouldOneMillimetreAboveGround) {
  const Horizon horizon({kEarth + 1e-3, 0, 0}, kEarth, 1e-3, kEarth);
  const auto onGround = [](double meters) {
    return glm::dvec3(std::cos(meters / kEarth), std::sin(meters / kEarth), 0) * kEarth;
  };
  EXPECT_FALSE(horizon.hides(onGround(100)));
  EXPECT_TRUE(horizon.hides(onGround(130)));
}

TEST(Horizon, HidesNothingFromAtOrInsideTheSphere) {
  for (const double altitude : {0.0, -1e-9, -100.0, -kEarth, -1e9}) {
    const Horizon horizon({kEarth + altitude, 0, 0}, kEarth, altitude, kEarth);
    EXPECT_FALSE(horizon.active());
    EXPECT_FALSE(horizon.hides({-kEarth, 0, 0}));
  }
  // In a crater: below the reference sphere, above the lowest terrain.
  EXPECT_TRUE(Horizon({kEarth - 500, 0, 0}, kEarth, -500, kEarth - 1000).active());
  EXPECT_FALSE(Horizon({kEarth - 1000, 0, 0}, kEarth, -1000, kEarth - 1000).active());
}

TEST(Horizon, NeverHidesAPointThatIsNotFinite) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  const Horizon horizon({kEarth + 100, 0, 0}, kEarth, 100, kEarth);
  for (const glm::dvec3& point :
       {glm::dvec3(kNaN), glm::dvec3(-kEarth, kNaN, 0), glm::dvec3(-kInfinity, 0, 0), glm::dvec3(-1e300, 0, 0)})
    EXPECT_FALSE(horizon.hides(point));
  for (const double bad : {kNaN, kInfinity})
    EXPECT_FALSE(Horizon({bad, 0, 0}, kEarth, bad, kEarth).hides({-kEarth, 0, 0}));
}

}  // namespace
}  // namespace terrane

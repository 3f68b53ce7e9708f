// The horizon, from a micrometre above ground to far out: its distance against MPFR, and that it hides what the sphere
// stands before and nothing else, nothing at all from at or inside the sphere.

#include "common/view/horizon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <limits>
#include <random>

#include "tests/numeric/samples.h"
#include "tests/support/high_precision.h"

namespace terrane {
namespace {

constexpr double kEarth = 6'371'000.0;

using test::HighPrecision;

HighPrecision exactDistance(double radiusMeters, double heightMeters) {
  const HighPrecision r = radiusMeters, h = heightMeters;
  return sqrt(HighPrecision(h * (2 * r + h)));
}

double relativeError(double distance, const HighPrecision& exact) {
  return static_cast<double>(HighPrecision(abs(HighPrecision(HighPrecision(distance) / exact - 1))));
}

/// The control: the textbook's formula, from the distance to the centre.
template <class Real>
Real textbook(Real radius, Real height) {
  const Real distance = radius + height;
  return std::sqrt(distance * distance - radius * radius);
}

TEST(HorizonDistance, IsRightFromOneMetreAndOneMillimetreWhereFloatLosesIt) {
  EXPECT_NEAR(horizonDistanceMeters(kEarth, 1.0), 3569.594, 0.001);
  EXPECT_NEAR(horizonDistanceMeters(kEarth, 1e-3), 112.880, 0.001);
  std::cout << "control, float: " << textbook(6'371'000.0f, 1.0f) << " m from 1 m, " << textbook(6'371'000.0f, 1e-3f)
            << " m from 1 mm\n";
  EXPECT_NEAR(textbook(6'371'000.0f, 1.0f), 3547, 1) << "22 m short";
  EXPECT_EQ(textbook(6'371'000.0f, 1e-3f), 0.0f) << "no horizon at all";
}

TEST(HorizonDistance, IsWithinFourRoundingsFromAMicrometreUp) {
  // Two sums and a product under the root count half each, the root's own rounding once: 2.5 u. The header says 4.
  const double bound = 4 * 0x1p-53;
  double worst = 0, worstControl = 0;
  for (const double radius : {250.0, 1'737'400.0, kEarth, 7e8}) {
    for (double height = 1e-6; height < 1e12; height *= 1.37) {
      const HighPrecision exact = exactDistance(radius, height);
      const double error = relativeError(horizonDistanceMeters(radius, height), exact);
      ASSERT_LE(error, bound) << height << " m over " << radius;
      worst = std::max(worst, error);
      worstControl = std::max(worstControl, relativeError(textbook(radius, height), exact));
    }
  }
  std::cout << "worst " << worst << ", bound " << bound
            << "; control, the textbook's formula in double: " << worstControl << '\n';
  EXPECT_GT(worstControl, 0.01);
}

TEST(HorizonDistance, IsZeroAtTheSphereAndInsideIt) {
  EXPECT_EQ(horizonDistanceMeters(kEarth, 0), 0);
  EXPECT_EQ(horizonDistanceMeters(kEarth, -0.0), 0);
  EXPECT_EQ(horizonDistanceMeters(kEarth, -5), 0);
  EXPECT_EQ(horizonDistanceMeters(kEarth, std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_TRUE(std::isnan(textbook(kEarth, -5.0))) << "the control";
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
  std::mt19937_64 random = test::seededRandom(45);
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

/// The control: the test without asking first whether there is a horizon (Ring 2013, as it is written).
bool hidesUnasked(const glm::dvec3& camera, const glm::dvec3& point, double occluderMeters) {
  const glm::dvec3 c = camera / occluderMeters, toPoint = point / occluderMeters - c;
  const double horizonSquared = glm::dot(c, c) - 1, inward = -glm::dot(toPoint, c);
  return inward > horizonSquared && inward * inward > horizonSquared * glm::dot(toPoint, toPoint);
}

TEST(Horizon, HidesNothingFromAtOrInsideTheSphere) {
  for (const double altitude : {0.0, -1e-9, -100.0, -kEarth, -1e9}) {
    const Horizon horizon({kEarth + altitude, 0, 0}, kEarth, altitude, kEarth);
    EXPECT_FALSE(horizon.active());
    EXPECT_FALSE(horizon.hides({-kEarth, 0, 0}));
  }
  // From inside, nothing stands before the far wall.
  EXPECT_TRUE(hidesUnasked({kEarth - 100, 0, 0}, {-kEarth, 0, 0}, kEarth)) << "the control hides it";
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

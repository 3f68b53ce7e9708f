#include "client/flight/flight_file.h"
#include "client/flight/ground_flight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "tests/support/temporary_folder.h"

namespace terrane {
namespace {

using ::testing::HasSubstr;
constexpr double kRadius = 1'737'400;
constexpr double kDegree = std::numbers::pi / 180;

Flight parsed(std::string_view text) {
  auto flight = parseFlight(text, "test.flight");
  EXPECT_TRUE(flight) << flight.error().text();
  return flight ? *flight : Flight();
}

glm::dvec3 directionOf(const ViewPose& pose) {
  return {std::cos(pose.latitude) * std::cos(pose.longitude), std::cos(pose.latitude) * std::sin(pose.longitude),
          std::sin(pose.latitude)};
}

TEST(FlightFile, ReadsWhatAPersonWrites) {
  const Flight flight = parsed(
      "# terrane flight 1\r\n"
      "above-ground   # heights from here\n"
      "\n"
      "  0.0 -20.10 9.62 10000000 0 -90\n"
      "\t5 -20.10\t9.62 1e3 350 -45.5 # near now\r\n"
      "7.25 180 -90 0.2 -10 0");
  EXPECT_TRUE(flight.aboveGround);
  ASSERT_EQ(flight.points.size(), 3u);
  EXPECT_DOUBLE_EQ(flight.points[0].pose.longitude, -20.10 * kDegree);
  EXPECT_DOUBLE_EQ(flight.points[0].pose.altitudeMeters, 1e7);
  EXPECT_DOUBLE_EQ(flight.points[1].pose.pitch, -45.5 * kDegree);
  EXPECT_EQ(flight.durationSeconds(), 7.25);
}

TEST(FlightFile, EveryMistakeIsNamedWithItsLine) {
  struct Case {
    const char* text;
    const char* field;
    const char* says;
    ErrorKind kind = ErrorKind::Malformed;
  };
  for (const Case& c :
       {Case{"", "f:1", "no pose"}, Case{"# only\n# comments\n", "f:2", "no pose"},
        Case{"0 1 2 3 4", "f:1", "pitch is missing"}, Case{"0 1 2 3 4 5 6", "f:1", "more than six"},
        Case{"0 0 0 1 0 0\n\n1 0 0 x 0 0", "f:3", "altitude is no finite number: \"x\""},
        Case{"0 nan 0 1 0 0", "f:1", "longitude is no finite"}, Case{"0 0 0 inf 0 0", "f:1", "altitude is no finite"},
        Case{"0 0 0 1e999 0 0", "f:1", "altitude is no finite"}, Case{"0 0 0 1e20 0 0", "f:1", "altitude must be from"},
        Case{"0 0 90.5 1 0 0", "f:1", "latitude must be from -90 to 90"},
        Case{"0 0 0 1 361 0", "f:1", "heading must be"}, Case{"0 0 0 1 0 -91", "f:1", "pitch must be"},
        Case{"-1 0 0 1 0 0", "f:1", "seconds must be"}, Case{"1 0 0 1 0 0\n1 0 0 1 0 0", "f:2", "does not come after"},
        Case{"1 0 0 1 0 0\n0.5 0 0 1 0 0", "f:2", "does not come after"},
        Case{"1 0 0 1 0 0\nabove-ground", "f:2", "before the first pose"},
        Case{"above-ground yes\n0 0 0 1 0 0", "f:1", "stands alone"},
        Case{"0 0 0 1,5 0 0", "f:1", "altitude is no finite number"},
        Case{"# terrane flight 2\n0 0 0 1 0 0", "f:1", "version", ErrorKind::Unsupported}}) {
    const auto flight = parseFlight(c.text, "f");
    ASSERT_FALSE(flight) << c.text;
    EXPECT_EQ(flight.error().field, c.field) << c.text;
    EXPECT_EQ(flight.error().kind, c.kind) << c.text;
    EXPECT_THAT(flight.error().message, HasSubstr(c.says)) << c.text;
  }
}

TEST(FlightFile, WhatIsWrittenReadsBackTheSame) {
  constexpr unsigned kSeed = 99;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 200; ++round) {
    Flight flight;
    flight.aboveGround = round % 2;
    double seconds = 0;
    for (int i = 0; i < 20; ++i) {
      seconds += std::exp(8 * unit(random));
      flight.points.push_back(
          {seconds,
           {unit(random) * std::numbers::pi, unit(random) * std::numbers::pi / 2, std::exp(20 * unit(random)),
            unit(random) * std::numbers::pi, unit(random) * std::numbers::pi / 2}});
    }
    const std::string text = writeFlight(flight);
    const Flight back = parsed(text);
    EXPECT_EQ(back.aboveGround, flight.aboveGround);
    ASSERT_EQ(back.points.size(), flight.points.size());
    for (std::size_t i = 0; i < flight.points.size(); ++i) {
      const ViewPose &a = flight.points[i].pose, &b = back.points[i].pose;
      EXPECT_EQ(back.points[i].seconds, flight.points[i].seconds);
      EXPECT_EQ(b.altitudeMeters, a.altitudeMeters);
      EXPECT_NEAR(b.longitude, a.longitude, 1e-12);
      EXPECT_NEAR(b.latitude, a.latitude, 1e-12);
      EXPECT_NEAR(b.heading, a.heading, 1e-12);
      EXPECT_NEAR(b.pitch, a.pitch, 1e-12);
    }
    EXPECT_EQ(writeFlight(back), text);
  }
}

TEST(FlightFile, AFullTurnTooManyIsWrittenSoThatItReads) {
  Flight flight;
  flight.points.push_back({0, {7.0, 0.1, 5, -9.0, -std::numbers::pi / 2}});
  const Flight back = parsed(writeFlight(flight));
  EXPECT_NEAR(std::remainder(back.points[0].pose.longitude - 7.0, 2 * std::numbers::pi), 0, 1e-12);
  EXPECT_NEAR(std::remainder(back.points[0].pose.heading + 9.0, 2 * std::numbers::pi), 0, 1e-12);
}

TEST(FlightFile, AnyBytesAreAFlightOrAnErrorWithALine) {
  constexpr unsigned kSeed = 4711;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  const std::string alphabet = "0123456789.-+e \t\r\n#abovegrundnif\xff\x01";
  const std::string valid = writeFlight(*builtInFlight("descent", -0.3, 0.2, kRadius));
  int flights = 0;
  for (int round = 0; round < 5000; ++round) {
    std::string text;
    if (round % 2) {
      text.resize(random() % 200);
      for (char& c : text) c = alphabet[random() % alphabet.size()];
    } else {
      text = valid;
      for (unsigned k = 0; k <= random() % 3; ++k) text[random() % text.size()] = static_cast<char>(random());
    }
    const auto flight = parseFlight(text, "f");
    if (!flight) {
      EXPECT_TRUE(flight.error().field.starts_with("f:"));
      continue;
    }
    ++flights;
    for (const FlightPoint& point : flight->points) {
      ASSERT_TRUE(std::isfinite(point.pose.longitude + point.pose.latitude + point.pose.altitudeMeters +
                                point.pose.heading + point.pose.pitch));
    }
    for (const double at : {-1.0, 0.0, flight->durationSeconds() / 3, flight->durationSeconds(), 1e300}) {
      const ViewPose pose = poseAt(*flight, at);
      ASSERT_TRUE(std::isfinite(pose.longitude + pose.latitude + pose.altitudeMeters + pose.heading + pose.pitch));
    }
  }
  EXPECT_GT(flights, 50);
}

TEST(FlightFile, LoadsAFileAndNamesOneThatIsMissing) {
  const testing_support::TemporaryFolder folder;
  std::ofstream(folder / "a.flight") << "0 0 0 5 0 0\nwrong\n";
  const auto flight = loadFlight(folder / "a.flight");
  ASSERT_FALSE(flight);
  EXPECT_EQ(flight.error().field, folder / "a.flight:2");
  const auto missing = loadFlight(folder / "b.flight");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::Io);
  EXPECT_EQ(missing.error().field, "--flight");
  EXPECT_FALSE(loadFlight(folder.path())) << "a folder is no flight";
}

TEST(FlightFile, BetweenPointsTheWayIsAGreatCircleAndTheFallIsLogarithmic) {
  const Flight flight = parsed("0 170 10 1000000 350 -90\n10 -170 -10 100 10 -20\n20 -170 -10 -50 10 -20");
  const ViewPose half = poseAt(flight, 5);
  EXPECT_NEAR(std::abs(half.longitude), std::numbers::pi, 1e-9) << "over the antimeridian, not round the other way";
  EXPECT_NEAR(half.latitude, 0, 1e-9);
  EXPECT_NEAR(half.altitudeMeters, 1e4, 1e-6);
  EXPECT_NEAR(std::remainder(half.heading, 2 * std::numbers::pi), 0, 1e-9) << "from 350 to 10 through 0";
  EXPECT_NEAR(half.pitch, -55 * kDegree, 1e-9);
  EXPECT_NEAR(poseAt(flight, 15).altitudeMeters, 25, 1e-9) << "with an end below zero it is linear";

  const glm::dvec3 a = directionOf(flight.points[0].pose), b = directionOf(flight.points[1].pose);
  const glm::dvec3 pole = glm::normalize(glm::cross(a, b));
  const double whole = std::acos(glm::dot(a, b));
  for (int i = 0; i <= 10; ++i) {
    const glm::dvec3 at = directionOf(poseAt(flight, i));
    EXPECT_NEAR(glm::dot(at, pole), 0, 1e-12);
    EXPECT_NEAR(std::acos(std::clamp(glm::dot(a, at), -1.0, 1.0)), whole * i / 10, 1e-7);
  }
}

TEST(FlightFile, TheEndsHoldTheirPosesExactly) {
  const Flight flight = parsed("1 -20.1 9.62 1000 10 -90\n2 -20.1 9.62 10 20 -20");
  for (const auto& [seconds, index] : {std::pair{0.0, 0u}, {1.0, 0u}, {2.0, 1u}, {99.0, 1u}}) {
    const ViewPose pose = poseAt(flight, seconds), expected = flight.points[index].pose;
    EXPECT_EQ(pose.longitude, expected.longitude);
    EXPECT_EQ(pose.latitude, expected.latitude);
    EXPECT_EQ(pose.altitudeMeters, expected.altitudeMeters);
    EXPECT_EQ(pose.heading, expected.heading);
    EXPECT_EQ(pose.pitch, expected.pitch);
  }
  EXPECT_EQ(poseAt(flight, 1.5).longitude, flight.points[0].pose.longitude)
      << "a vertical descent stays over its place to the last bit";
  EXPECT_EQ(poseAt(flight, std::nan("")).altitudeMeters, 1000);
}

TEST(FlightFile, OppositePlacesAreJoinedOverAPole) {
  const Flight flight = parsed("0 30 0 10 0 0\n2 -150 0 10 0 0");
  const ViewPose half = poseAt(flight, 1);
  EXPECT_NEAR(std::abs(half.latitude), 90 * kDegree, 1e-6);
  EXPECT_TRUE(std::isfinite(half.longitude));
}

TEST(BuiltInFlight, TheDescentFallsThroughItsWayPointsAboveGround) {
  const auto flight = builtInFlight("descent", -0.35, 0.168, kRadius);
  ASSERT_TRUE(flight);
  EXPECT_TRUE(flight->aboveGround);
  ASSERT_EQ(flight->points.size(), kDescentAltitudesMeters.size());
  EXPECT_NEAR(flight->durationSeconds(), 60, 1e-9);
  for (std::size_t i = 0; i < flight->points.size(); ++i) {
    EXPECT_EQ(flight->points[i].pose.altitudeMeters, kDescentAltitudesMeters[i]);
    EXPECT_EQ(flight->points[i].pose.longitude, -0.35);
    EXPECT_EQ(flight->points[i].pose.latitude, 0.168);
  }
  EXPECT_NEAR(flight->points.front().pose.pitch, -90 * kDegree, 1e-12);
  EXPECT_NEAR(flight->points.back().pose.pitch, -20 * kDegree, 1e-12);
  // One pace in the logarithm all the way, and the view only ever rises.
  ViewPose before = poseAt(*flight, 0);
  for (double t = 0.5; t <= 60; t += 0.5) {
    const ViewPose pose = poseAt(*flight, t);
    EXPECT_NEAR(std::log(before.altitudeMeters / pose.altitudeMeters), std::log(1e7 / 0.2) / 120, 1e-9);
    EXPECT_GE(pose.pitch, before.pitch);
    before = pose;
  }
  EXPECT_TRUE(parseFlight(writeFlight(*flight), "f"));
}

TEST(BuiltInFlight, TheOrbitGoesOnceAroundLookingAhead) {
  for (const double latitude : {0.0, 0.5, -1.2, std::numbers::pi / 2}) {
    const auto flight = builtInFlight("orbit", 0.7, latitude, kRadius);
    ASSERT_TRUE(flight);
    EXPECT_FALSE(flight->aboveGround);
    double travelled = 0;
    for (std::size_t i = 1; i < flight->points.size(); ++i) {
      const ViewPose &a = flight->points[i - 1].pose, &b = flight->points[i].pose;
      EXPECT_NEAR(b.altitudeMeters, 1e5, 1e-6);
      const glm::dvec3 from = directionOf(a), to = directionOf(b);
      travelled += std::acos(glm::dot(from, to));
      const glm::dvec3 east(-std::sin(a.longitude), std::cos(a.longitude), 0);
      const glm::dvec3 ahead = std::cos(a.heading) * glm::cross(from, east) + std::sin(a.heading) * east;
      EXPECT_GT(glm::dot(ahead, glm::normalize(to - from)), 0.99);
    }
    EXPECT_NEAR(travelled, 2 * std::numbers::pi, 1e-6);
    EXPECT_NEAR(glm::distance(directionOf(flight->points.front().pose), directionOf(flight->points.back().pose)), 0,
                1e-9);
    EXPECT_TRUE(parseFlight(writeFlight(*flight), "f"));
  }
}

/// Speed over ground, heading, pitch and the logarithm of the height, a second.
struct Motion {
  glm::dvec3 walk;
  double turn, nod, climb;
};

Motion motionAt(const Flight& flight, double seconds, double over) {
  const ViewPose a = poseAt(flight, seconds), b = poseAt(flight, seconds + over);
  return {(directionOf(b) - directionOf(a)) * kRadius / over,
          std::remainder(b.heading - a.heading, 2 * std::numbers::pi) / over, (b.pitch - a.pitch) / over,
          std::log(b.altitudeMeters / a.altitudeMeters) / over};
}

TEST(BuiltInFlight, TheWalkGoesSomeHundredMetresSmoothlyThroughItsHeights) {
  for (const double latitude : {0.377, -1.2, std::numbers::pi / 2}) {
    const auto flight = builtInFlight("ground", -0.286, latitude, kRadius);
    ASSERT_TRUE(flight);
    EXPECT_TRUE(flight->aboveGround);
    EXPECT_NEAR(flight->durationSeconds(), kGroundHeights.back().seconds, 1e-9);
    for (const auto& height : kGroundHeights)
      EXPECT_NEAR(poseAt(*flight, height.seconds).altitudeMeters, height.metersAboveGround, 1e-9);
    constexpr double kStep = 1.0 / 30;
    double walked = 0, lowest = 1e9, highest = 0, leftmost = 0, rightmost = 0;
    Motion before = motionAt(*flight, 0, kStep);
    for (int i = 1; i < 30 * 60; ++i) {
      const Motion now = motionAt(*flight, i * kStep, kStep);
      const ViewPose pose = poseAt(*flight, i * kStep);
      walked += glm::length(now.walk) * kStep;
      lowest = std::min(lowest, pose.altitudeMeters);
      highest = std::max(highest, pose.altitudeMeters);
      leftmost = std::min(leftmost, now.turn);
      rightmost = std::max(rightmost, now.turn);
      EXPECT_GT(glm::length(now.walk), 0.5) << "it never stands still";
      EXPECT_LT(glm::length(now.walk), 8);
      // From frame to frame next to nothing changes: no kink, no jerk.
      EXPECT_LT(glm::length(now.walk - before.walk), 0.5) << i;
      EXPECT_LT(std::abs(now.turn - before.turn), 3 * kDegree) << i;
      EXPECT_LT(std::abs(now.nod - before.nod), 3 * kDegree) << i;
      EXPECT_LT(std::abs(now.climb - before.climb), 0.15) << i;
      before = now;
    }
    EXPECT_GT(walked, 150);
    EXPECT_LT(walked, 400);
    EXPECT_NEAR(lowest, 0.2, 1e-9);
    EXPECT_NEAR(highest, 30, 1e-9);
    EXPECT_LT(leftmost, -10 * kDegree) << "the head turns one way";
    EXPECT_GT(rightmost, 10 * kDegree) << "and the other";
    EXPECT_TRUE(parseFlight(writeFlight(*flight), "f"));
  }
}

TEST(BuiltInFlight, TheWalkIsAsLongOnEveryBody) {
  for (const double radius : {1e3, kRadius, 7e7}) {
    const auto flight = builtInFlight("ground", 1, 0.5, radius);
    ASSERT_TRUE(flight);
    double walked = 0;
    for (std::size_t i = 1; i < flight->points.size(); ++i)
      walked += radius * glm::distance(directionOf(flight->points[i].pose), directionOf(flight->points[i - 1].pose));
    EXPECT_NEAR(walked, 240, 90) << radius;
  }
}

TEST(BuiltInFlight, UnknownNamesAndImpossiblePlacesNameTheFlag) {
  for (const auto& flight :
       {builtInFlight("ascent", 0, 0, kRadius), builtInFlight("descent", std::nan(""), 0, kRadius),
        builtInFlight("orbit", 0, 2, kRadius), builtInFlight("ground", 0, std::nan(""), kRadius)}) {
    ASSERT_FALSE(flight);
    EXPECT_EQ(flight.error().field, "--flight");
    EXPECT_EQ(flight.error().kind, ErrorKind::InvalidArgument);
  }
}

}  // namespace
}  // namespace terrane

#include "client/flight/ground_flight.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace terrane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kMaxLatitude = 85 * kDegree;
constexpr double kCurveRadiusMeters = 150;
constexpr double kFastestMetersPerSecond = 6;
constexpr double kLookSeconds = 15, kNodSeconds = 11;
/// Points a second, and steps of the walk between two points.
constexpr int kPointsPerSecond = 4, kStepsPerPoint = 16;

double heightAt(double seconds) {
  const auto after = std::upper_bound(kGroundHeights.begin(), kGroundHeights.end() - 1, seconds,
                                      [](double time, const GroundHeight& height) { return time < height.seconds; });
  const GroundHeight &a = *(after - 1), &b = *after;
  const double f = std::clamp((seconds - a.seconds) / (b.seconds - a.seconds), 0.0, 1.0);
  const double eased = f * f * (3 - 2 * f);
  return a.metersAboveGround * std::pow(b.metersAboveGround / a.metersAboveGround, eased);
}

double paceAt(double seconds) {
  const double height = heightAt(seconds);
  return kFastestMetersPerSecond * height / (height + 0.5);
}

}  // namespace

Flight groundFlight(double longitude, double latitude, double radiusMeters) {
  latitude = std::clamp(latitude, -kMaxLatitude, kMaxLatitude);
  const double cosine = std::cos(latitude), sine = std::sin(latitude);
  const glm::dvec3 up(cosine * std::cos(longitude), cosine * std::sin(longitude), sine);
  const glm::dvec3 east(-std::sin(longitude), std::cos(longitude), 0);
  const glm::dvec3 north = glm::cross(up, east);
  Flight flight;
  flight.aboveGround = true;
  const int points = static_cast<int>(kGroundHeights.back().seconds) * kPointsPerSecond;
  const double step = 1.0 / (kPointsPerSecond * kStepsPerPoint);
  double walked = 0;
  for (int i = 0; i <= points; ++i) {
    const double seconds = static_cast<double>(i) / kPointsPerSecond;
    // An arc in the plane that touches the body at the first place, and its direction, on the body.
    const double turned = walked / kCurveRadiusMeters;
    const glm::dvec3 arc =
        kCurveRadiusMeters / radiusMeters * (std::sin(turned) * east + (1 - std::cos(turned)) * north);
    const glm::dvec3 at = glm::normalize(up + arc);
    const glm::dvec3 ahead = std::cos(turned) * east + std::sin(turned) * north;
    const double around = std::hypot(at.x, at.y);
    const glm::dvec3 eastHere(-at.y / around, at.x / around, 0);
    ViewPose pose;
    pose.longitude = std::atan2(at.y, at.x);
    pose.latitude = std::atan2(at.z, around);
    pose.altitudeMeters = heightAt(seconds);
    pose.heading = std::atan2(glm::dot(ahead, eastHere), glm::dot(ahead, glm::cross(at, eastHere))) +
                   40 * kDegree * std::sin(2 * kPi * seconds / kLookSeconds);
    // From high up it looks further down.
    pose.pitch = (-10 + 7 * std::sin(2 * kPi * seconds / kNodSeconds)) * kDegree -
                 20 * kDegree * pose.altitudeMeters / (pose.altitudeMeters + 20);
    flight.points.push_back({seconds, pose});
    for (int k = 0; k < kStepsPerPoint; ++k) walked += step * paceAt(seconds + (k + 0.5) * step);
  }
  return flight;
}

}  // namespace terrane

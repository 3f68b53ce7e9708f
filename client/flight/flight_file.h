#pragma once
// A recorded flight: times and poses, one a line, written by --record and flown by --flight. Text, so that a person can
// write one:
//   # terrane flight 1
//   # seconds longitude latitude altitude heading pitch   (degrees, metres above the reference sphere)
//   0.0 -20.10 9.62 10000000 0 -90
// A line "above-ground" before the first pose makes altitudes count from the finest ground under the camera. Longitudes
// -360 to 360, latitudes and pitch -90 to 90, headings -360 to 360; times start at 0 or later and increase. A "#"
// begins a comment. Between lines: altitude interpolates in its logarithm when both ends are positive, the place along
// the great circle, the heading the shorter way round, the pitch evenly. Radians in here. Thread-safe.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "common/view/camera.h"

namespace terrane {

/// No more lines than this are read.
inline constexpr std::size_t kMaxFlightPoints = 1'000'000;

struct FlightPoint {
  double seconds = 0;
  ViewPose pose;
};

struct Flight {
  bool aboveGround = false;
  std::vector<FlightPoint> points;  ///< at least one, strictly increasing times
  double durationSeconds() const { return points.empty() ? 0 : points.back().seconds; }
};

/// Errors: Malformed, Unsupported, TooLarge; field is "FILE:LINE". Io from loadFlight, field "--flight".
Result<Flight> parseFlight(std::string_view text, std::string_view fileName);
Result<Flight> loadFlight(const std::string& file);
/// Angles to 14 digits (a micrometre on the Moon), times and altitudes exactly; what is read back writes the same text.
std::string writeFlight(const Flight& flight);
/// Before the first time the first pose, after the last the last.
ViewPose poseAt(const Flight& flight, double seconds);

/// Heights above ground of the descent's way-points, one for each of its points.
inline constexpr std::array<double, 8> kDescentAltitudesMeters{1e7, 1e6, 1e5, 1e4, 1e3, 1e2, 2.0, 0.2};

/// "descent": 10,000 km to 0.2 m over one place; "orbit": once around at 100 km, leaving eastward; "ground": a walk
/// (ground_flight.h). Radians; the radius is the body's. Errors name "--flight".
Result<Flight> builtInFlight(std::string_view name, double longitude, double latitude, double radiusMeters);
inline constexpr std::string_view kBuiltInFlights = "descent, orbit and ground";

}  // namespace terrane

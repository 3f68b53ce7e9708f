#pragma once
// The frames of a scripted run, before any is drawn: a pose for each, and which of them are points of the flight.
// Thread-safe.

#include <optional>
#include <string>
#include <vector>

#include "client/app/view_options.h"
#include "client/flight/flight_file.h"
#include "common/result.h"
#include "common/view/camera.h"

namespace terrane {

struct PlannedFrame {
  double seconds = 0;
  ViewPose pose;
  int point = -1;  ///< index of the flight's point that this frame shows; -1 between points
};

struct FlightPlan {
  bool aboveGround = false;
  std::vector<PlannedFrame> frames;
  std::size_t points = 0;
};

/// Reads the file of --flight, if it names one, into options: before anything else, so that a wrong one is found at
/// once. Errors: InvalidArgument naming "--flight".
Result<void> readFlight(ViewOptions& options);

/// What was read, or the built-in flight that --flight names ("descent", "orbit", "ground"). place: where built-in
/// flights go.
Result<Flight> flightOf(const ViewOptions& options, const ViewPose& place, double radiusMeters);

/// Frames every stepSeconds from the first point on, and one at exactly each point's time. maxFrames 0: all of them.
/// Errors: TooLarge naming "--step" beyond ten million frames.
Result<FlightPlan> planFlight(const Flight& flight, double stepSeconds, std::size_t maxFrames);

/// So many frames over the whole flight, one at exactly each point's time, the others evenly between them; of fewer
/// frames than points each is a point. Precondition: count > 0.
FlightPlan planFlightInFrames(const Flight& flight, std::size_t count);

/// count frames of one pose.
FlightPlan planStill(const ViewPose& pose, bool aboveGround, std::size_t count, double stepSeconds);

/// "out-%d.png" and 3: "out-3.png".
std::string numberedFile(std::string pattern, std::size_t number);

}  // namespace terrane

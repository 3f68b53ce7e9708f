#pragma once
// Collects a flight while it is flown: at most thirty points a second, and a point before each pause ends, so that the
// flight rests as long as the person did. One thread.

#include "client/flight/flight_file.h"

namespace terrane {

class FlightRecorder {
 public:
  /// Times must not decrease.
  void add(double seconds, const ViewPose& pose) {
    const bool first = flight_.points.empty();
    if (!first && seconds - flight_.points.back().seconds < kShortestStep) return;
    if (!first && seconds - flight_.points.back().seconds > 4 * kShortestStep)
      flight_.points.push_back({seconds - kShortestStep / 2, last_});
    flight_.points.push_back({seconds, pose});
    last_ = pose;
  }
  const Flight& flight() const noexcept { return flight_; }

 private:
  static constexpr double kShortestStep = 1.0 / 30;
  Flight flight_;
  ViewPose last_;
};

}  // namespace terrane

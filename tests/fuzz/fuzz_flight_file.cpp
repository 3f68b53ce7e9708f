// Any bytes are a flight or an error; a flight has finite poses at any time, and what it is written as reads back.

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "client/flight/flight_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto flight = terrane::parseFlight({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!flight) return 0;
  for (const double seconds : {0.0, flight->durationSeconds() / 3, flight->durationSeconds()}) {
    const terrane::ViewPose pose = terrane::poseAt(*flight, seconds);
    if (!std::isfinite(pose.longitude + pose.latitude + pose.altitudeMeters + pose.heading + pose.pitch)) std::abort();
  }
  if (!terrane::parseFlight(terrane::writeFlight(*flight), "again")) std::abort();
  return 0;
}

#include "client/app/flight_plan.h"

#include <fmt/format.h>

namespace terrane {
namespace {

constexpr double kMostFrames = 1e7;
// A step that ends this close to a point is the point: both would be the same picture.
constexpr double kSameFrame = 1e-6;

}  // namespace

Result<Flight> openFlight(const std::string& nameOrFile, const ViewPose& place) {
  if (nameOrFile == "descent" || nameOrFile == "orbit")
    return builtInFlight(nameOrFile, place.longitude, place.latitude);
  auto flight = loadFlight(nameOrFile);
  if (flight) return flight;
  const Error& error = flight.error();
  return makeError(ErrorKind::InvalidArgument, "--flight",
                   (error.field == "--flight" ? error.message : error.text()) + " (built in are descent and orbit)");
}

Result<FlightPlan> planFlight(const Flight& flight, double stepSeconds, std::size_t maxFrames) {
  const double start = flight.points.front().seconds;
  if ((flight.durationSeconds() - start) / stepSeconds > kMostFrames)
    return makeError(ErrorKind::InvalidArgument, "--step",
                     fmt::format("{} s makes more than {:.0f} frames of this flight", stepSeconds, kMostFrames));
  FlightPlan plan;
  plan.aboveGround = flight.aboveGround;
  plan.points = flight.points.size();
  const auto full = [&] { return maxFrames != 0 && plan.frames.size() >= maxFrames; };
  std::uint64_t step = 0;
  for (std::size_t i = 0; i < flight.points.size() && !full(); ++i) {
    const double end = flight.points[i].seconds;
    for (double t = start + static_cast<double>(step) * stepSeconds; t < end - kSameFrame * stepSeconds && !full();
         t = start + static_cast<double>(++step) * stepSeconds)
      if (i > 0 && t > flight.points[i - 1].seconds + kSameFrame * stepSeconds)
        plan.frames.push_back({t, poseAt(flight, t), -1});
    if (!full()) plan.frames.push_back({end, flight.points[i].pose, static_cast<int>(i)});
  }
  return plan;
}

FlightPlan planStill(const ViewPose& pose, bool aboveGround, std::size_t count, double stepSeconds) {
  FlightPlan plan;
  plan.aboveGround = aboveGround;
  for (std::size_t i = 0; i < count; ++i) plan.frames.push_back({static_cast<double>(i) * stepSeconds, pose, -1});
  return plan;
}

std::string numberedFile(std::string pattern, std::size_t number) {
  const std::size_t at = pattern.find("%d");
  return at == std::string::npos ? pattern : pattern.replace(at, 2, std::to_string(number));
}

}  // namespace terrane

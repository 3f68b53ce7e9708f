#include "client/app/flight_plan.h"

#include <fmt/format.h>

#include <cmath>

namespace terrane {
namespace {

constexpr double kMostFrames = 1e7;
// A step that ends this close to a point is the point: both would be the same picture.
constexpr double kSameFrame = 1e-6;

}  // namespace

Result<void> readFlight(ViewOptions& options) {
  const std::string& name = options.flight;
  if (name.empty() || name == "descent" || name == "orbit" || name == "ground") return {};
  auto flight = loadFlight(name);
  if (flight) {
    options.flightOfFile = std::move(*flight);
    return {};
  }
  const Error& error = flight.error();
  return makeError(
      ErrorKind::InvalidArgument, "--flight",
      fmt::format("{} (built in are {})", error.field == "--flight" ? error.message : error.text(), kBuiltInFlights));
}

Result<Flight> flightOf(const ViewOptions& options, const ViewPose& place, double radiusMeters) {
  if (options.flightOfFile) return *options.flightOfFile;
  return builtInFlight(options.flight, place.longitude, place.latitude, radiusMeters);
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

FlightPlan planFlightInFrames(const Flight& flight, std::size_t count) {
  const auto& points = flight.points;
  FlightPlan plan;
  plan.aboveGround = flight.aboveGround;
  plan.points = points.size();
  if (count < points.size()) {
    for (std::size_t frame = 0; frame < count; ++frame) {
      const std::size_t i = count == 1 ? 0 : frame * (points.size() - 1) / (count - 1);
      plan.frames.push_back({points[i].seconds, points[i].pose, static_cast<int>(i)});
    }
    return plan;
  }
  // How many of the frames that are no points lie before a time.
  const double start = points.front().seconds, whole = points.back().seconds - start;
  const auto framesBefore = [&](double seconds) {
    return std::llround((seconds - start) / whole * static_cast<double>(count - points.size()));
  };
  plan.frames.push_back({start, points.front().pose, 0});
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double from = points[i - 1].seconds, to = points[i].seconds;
    const auto between = framesBefore(to) - framesBefore(from);
    for (long long k = 1; k <= between; ++k) {
      const double t = from + (to - from) * static_cast<double>(k) / static_cast<double>(between + 1);
      plan.frames.push_back({t, poseAt(flight, t), -1});
    }
    plan.frames.push_back({to, points[i].pose, static_cast<int>(i)});
  }
  // A flight of a single point stands still.
  while (plan.frames.size() < count) plan.frames.push_back({start, points.front().pose, -1});
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

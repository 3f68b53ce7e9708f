#include "client/flight/flight_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "client/flight/ground_flight.h"

namespace terrane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadiansPerDegree = kPi / 180.0;
constexpr std::string_view kHeader = "# terrane flight ";
constexpr double kMaxAltitudeMeters = 1e15;
constexpr double kMaxSeconds = 1e9;
constexpr std::size_t kMaxFileBytes = 256u << 20;

struct Column {
  std::string_view name;
  double minimum, maximum;
};
constexpr std::array<Column, 6> kColumns{{{"seconds", 0, kMaxSeconds},
                                          {"longitude", -360, 360},
                                          {"latitude", -90, 90},
                                          {"altitude", -kMaxAltitudeMeters, kMaxAltitudeMeters},
                                          {"heading", -360, 360},
                                          {"pitch", -90, 90}}};

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Cuts the next word off the line; empty at its end.
std::string_view nextWord(std::string_view& line) {
  while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
  std::size_t length = 0;
  while (length < line.size() && !isBlank(line[length])) ++length;
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

std::string shown(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  }
  return "\"" + text + "\"";
}

Result<FlightPoint> parsePose(std::string_view line, const std::string& where) {
  std::array<double, 6> value{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const Column& column = kColumns[i];
    const std::string_view word = nextWord(line);
    if (word.empty()) {
      return makeError(
          ErrorKind::Malformed, where,
          fmt::format("{} is missing; expected: seconds longitude latitude altitude heading pitch", column.name));
    }
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value[i]);
    if (failure != std::errc() || end != word.data() + word.size() || !std::isfinite(value[i])) {
      return makeError(ErrorKind::Malformed, where,
                       fmt::format("{} is no finite number: {}", column.name, shown(word)));
    }
    if (value[i] < column.minimum || value[i] > column.maximum) {
      return makeError(
          ErrorKind::Malformed, where,
          fmt::format("{} must be from {} to {}: {}", column.name, column.minimum, column.maximum, shown(word)));
    }
  }
  if (const std::string_view more = nextWord(line); !more.empty()) {
    return makeError(ErrorKind::Malformed, where, "more than six numbers: " + shown(more));
  }
  FlightPoint point;
  point.seconds = value[0];
  point.pose = {value[1] * kRadiansPerDegree, value[2] * kRadiansPerDegree, value[3], value[4] * kRadiansPerDegree,
                value[5] * kRadiansPerDegree};
  return point;
}

double angleBetween(double from, double to) { return std::remainder(to - from, 2 * kPi); }

glm::dvec3 directionOf(const ViewPose& pose) {
  return {std::cos(pose.latitude) * std::cos(pose.longitude), std::cos(pose.latitude) * std::sin(pose.longitude),
          std::sin(pose.latitude)};
}

/// Along the great circle; over a pole if the two are opposite.
void interpolatePlace(const ViewPose& a, const ViewPose& b, double f, ViewPose& pose) {
  const glm::dvec3 from = directionOf(a), to = directionOf(b);
  glm::dvec3 side = to - glm::dot(from, to) * from;
  const double sine = glm::length(side);
  const double angle = std::atan2(sine, glm::dot(from, to));
  // So near that a straight line in angles is the same to the last digits, and keeps them.
  if (angle < 1e-7) {
    pose.longitude = a.longitude + f * angleBetween(a.longitude, b.longitude);
    pose.latitude = a.latitude + f * (b.latitude - a.latitude);
    return;
  }
  if (sine < 1e-9)
    side = {-std::sin(a.latitude) * std::cos(a.longitude), -std::sin(a.latitude) * std::sin(a.longitude),
            std::cos(a.latitude)};
  side = glm::normalize(side);
  const glm::dvec3 at = std::cos(f * angle) * from + std::sin(f * angle) * side;
  pose.longitude = std::atan2(at.y, at.x);
  pose.latitude = std::atan2(at.z, std::hypot(at.x, at.y));
}

double interpolateAltitude(double a, double b, double f) {
  if (a > 0 && b > 0) return a * std::pow(b / a, f);
  return a + f * (b - a);
}

Flight descent(double longitude, double latitude) {
  // One logarithmic pace all the way; the view rises from straight down to the horizon over the last kilometres.
  constexpr double kSeconds = 60;
  constexpr std::array<double, kDescentAltitudesMeters.size()> kPitchDegrees{-90, -90, -90, -80, -65, -45, -25, -20};
  const double whole = std::log(kDescentAltitudesMeters.front() / kDescentAltitudesMeters.back());
  Flight flight;
  flight.aboveGround = true;
  for (std::size_t i = 0; i < kDescentAltitudesMeters.size(); ++i) {
    const double fallen = std::log(kDescentAltitudesMeters.front() / kDescentAltitudesMeters[i]);
    const double seconds = i + 1 == kDescentAltitudesMeters.size() ? kSeconds : kSeconds * fallen / whole;
    flight.points.push_back(
        {seconds, {longitude, latitude, kDescentAltitudesMeters[i], 0, kPitchDegrees[i] * kRadiansPerDegree}});
  }
  return flight;
}

Flight orbit(double longitude, double latitude) {
  constexpr int kParts = 72;
  constexpr double kSeconds = 120, kAltitudeMeters = 1e5, kPitch = -25 * kRadiansPerDegree;
  // Nearer to a pole "eastward" turns faster than the points follow.
  constexpr double kMaxLatitude = 85 * kRadiansPerDegree;
  ViewPose start;
  start.longitude = longitude;
  start.latitude = std::clamp(latitude, -kMaxLatitude, kMaxLatitude);
  const glm::dvec3 from = directionOf(start);
  const glm::dvec3 east(-std::sin(longitude), std::cos(longitude), 0);
  Flight flight;
  for (int i = 0; i <= kParts; ++i) {
    const double angle = 2 * kPi * i / kParts;
    const glm::dvec3 at = std::cos(angle) * from + std::sin(angle) * east;
    const glm::dvec3 ahead = std::cos(angle) * east - std::sin(angle) * from;
    const double around = std::hypot(at.x, at.y);
    const glm::dvec3 eastHere(-at.y / around, at.x / around, 0);
    const glm::dvec3 northHere = glm::cross(at, eastHere);
    ViewPose pose{std::atan2(at.y, at.x), std::atan2(at.z, around), kAltitudeMeters,
                  std::atan2(glm::dot(ahead, eastHere), glm::dot(ahead, northHere)), kPitch};
    flight.points.push_back({kSeconds * i / kParts, pose});
  }
  return flight;
}

}  // namespace

Result<Flight> parseFlight(std::string_view text, std::string_view fileName) {
  Flight flight;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++number;
    const auto where = [&] { return fmt::format("{}:{}", fileName, number); };
    if (line.starts_with(kHeader)) {
      std::string_view rest = line.substr(kHeader.size());
      const std::string_view version = nextWord(rest);
      if (version != "1") {
        return makeError(ErrorKind::Unsupported, where(),
                         "flight version " + shown(version) + "; this viewer reads version 1");
      }
    }
    line = line.substr(0, line.find('#'));
    std::string_view rest = line;
    const std::string_view first = nextWord(rest);
    if (first.empty()) continue;
    if (first == "above-ground") {
      if (!flight.points.empty())
        return makeError(ErrorKind::Malformed, where(), "above-ground must come before the first pose");
      if (!nextWord(rest).empty())
        return makeError(ErrorKind::Malformed, where(), "above-ground stands alone on its line");
      flight.aboveGround = true;
      continue;
    }
    auto point = parsePose(line, where());
    if (!point) return point.error();
    if (!flight.points.empty() && !(point->seconds > flight.points.back().seconds)) {
      return makeError(ErrorKind::Malformed, where(),
                       fmt::format("time {} does not come after {}", point->seconds, flight.points.back().seconds));
    }
    if (flight.points.size() == kMaxFlightPoints) {
      return makeError(ErrorKind::TooLarge, where(), fmt::format("more than {} poses", kMaxFlightPoints));
    }
    flight.points.push_back(*point);
  }
  if (flight.points.empty())
    return makeError(ErrorKind::Malformed, fmt::format("{}:{}", fileName, std::max<std::size_t>(number, 1)),
                     "no pose in the file");
  return flight;
}

Result<Flight> loadFlight(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return makeError(ErrorKind::Io, "--flight", "cannot open " + file);
  std::string text;
  std::array<char, 1 << 16> chunk{};
  while (stream.read(chunk.data(), chunk.size()) || stream.gcount() > 0) {
    text.append(chunk.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaxFileBytes)
      return makeError(ErrorKind::TooLarge, "--flight", file + " is larger than 256 MiB");
  }
  if (stream.bad()) return makeError(ErrorKind::Io, "--flight", "cannot read " + file);
  return parseFlight(text, file);
}

std::string writeFlight(const Flight& flight) {
  std::string text = "# terrane flight 1\n";
  text += flight.aboveGround
              ? "# seconds longitude latitude altitude heading pitch   (degrees, metres above ground)\nabove-ground\n"
              : "# seconds longitude latitude altitude heading pitch   (degrees, metres above the reference sphere)\n";
  // Whole turns beyond the range that a file may hold are dropped.
  const auto degrees = [](double radians) {
    return (std::abs(radians) > 2 * kPi ? std::remainder(radians, 2 * kPi) : radians) / kRadiansPerDegree;
  };
  for (const FlightPoint& point : flight.points) {
    const ViewPose& pose = point.pose;
    fmt::format_to(std::back_inserter(text), "{} {:.14g} {:.14g} {} {:.14g} {:.14g}\n", point.seconds,
                   degrees(pose.longitude), degrees(pose.latitude), pose.altitudeMeters, degrees(pose.heading),
                   degrees(pose.pitch));
  }
  return text;
}

ViewPose poseAt(const Flight& flight, double seconds) {
  const auto& points = flight.points;
  if (points.empty()) return {};
  if (!(seconds > points.front().seconds)) return points.front().pose;
  if (seconds >= points.back().seconds) return points.back().pose;
  const auto after = std::upper_bound(points.begin(), points.end(), seconds,
                                      [](double time, const FlightPoint& point) { return time < point.seconds; });
  const FlightPoint& a = *(after - 1);
  const FlightPoint& b = *after;
  const double f = (seconds - a.seconds) / (b.seconds - a.seconds);
  if (f == 0) return a.pose;
  ViewPose pose;
  interpolatePlace(a.pose, b.pose, f, pose);
  pose.altitudeMeters = interpolateAltitude(a.pose.altitudeMeters, b.pose.altitudeMeters, f);
  pose.heading = a.pose.heading + f * angleBetween(a.pose.heading, b.pose.heading);
  pose.pitch = a.pose.pitch + f * (b.pose.pitch - a.pose.pitch);
  return pose;
}

Result<Flight> builtInFlight(std::string_view name, double longitude, double latitude, double radiusMeters) {
  if (!std::isfinite(longitude) || !std::isfinite(latitude) || std::abs(latitude) > kPi / 2 + 1e-12) {
    return makeError(ErrorKind::InvalidArgument, "--flight",
                     "needs a place: a finite longitude and a latitude from -90 to 90 degrees");
  }
  if (name == "descent") return descent(longitude, latitude);
  if (name == "orbit") return orbit(longitude, latitude);
  if (name == "ground") return groundFlight(longitude, latitude, radiusMeters);
  return makeError(ErrorKind::InvalidArgument, "--flight",
                   fmt::format("{} is no flight; built in are {}, else name a file", shown(name), kBuiltInFlights));
}

}  // namespace terrane

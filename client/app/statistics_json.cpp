// The JSON of --stats. Small and flat enough to be written by hand; the JSON library stays with the wire formats.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "client/app/run_statistics.h"

namespace terrane {
namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20)
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      result += c;
  }
  return result + "\"";
}

// JSON has no word for infinity or NaN.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }
std::string milliseconds(double value) { return std::isfinite(value) ? fmt::format("{:.3f}", value) : "null"; }
const char* truth(bool value) { return value ? "true" : "false"; }

std::string selfTestJson(const SelfTestReport& report) {
  return fmt::format(
      R"({{"integerExact": {}, "twoSumExact": {}, "twoProdExact": {}, "twoSumWithoutPrecise": {}, "fmaFused": {}, "chosen": {}, )"
      R"("renderer": {}, "version": {}}})",
      truth(report.integerExact), truth(report.twoSumExact), truth(report.twoProdExact),
      truth(report.twoSumWithoutPrecise), truth(report.fmaFused), quoted(placementName(report.chosen)),
      quoted(report.renderer), quoted(report.version));
}

std::string cameraJson(const RunStatistics& s) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  return fmt::format(
      R"({{"longitude": {}, "latitude": {}, "altitudeMeters": {}, "heightAboveGroundMeters": {}, "heading": {}, "pitch": {}, )"
      R"("widthPixels": {}, "heightPixels": {}}})",
      number(s.pose.longitude * kDegrees), number(s.pose.latitude * kDegrees), number(s.pose.altitudeMeters),
      s.heightAboveGroundMeters < 0 ? "null" : number(s.heightAboveGroundMeters), number(s.pose.heading * kDegrees),
      number(s.pose.pitch * kDegrees), s.widthPixels, s.heightPixels);
}

std::string pointJson(const PointStatistics& p) {
  return fmt::format(
      R"({{"name": {}, "altitudeMeters": {}, "frames": {}, "medianMs": {}, "tilesDrawn": {}, "bytesReceived": {}, )"
      R"("uncoveredPixels": {}, "skirtPixels": {}, "capture": {}}})",
      quoted(p.name), number(p.altitudeMeters), p.frames, milliseconds(p.medianMs), p.tilesDrawn, p.bytesReceived,
      p.uncoveredPixels, p.skirtPixels, p.capture.empty() ? "null" : quoted(p.capture));
}

std::string bodyJson(const BodyStatus& b) {
  return fmt::format(
      R"({{"name": {}, "altitudeMeters": {}, "diameterPixels": {}, "tilesDrawn": {}, "tilesResident": {}}})",
      quoted(b.name), number(b.altitudeMeters), number(b.diameterPixels), b.tilesDrawn, b.tilesResident);
}

class Object {
 public:
  void add(std::string_view key, const std::string& json) {
    text_ += fmt::format("{}\n  \"{}\": {}", text_.empty() ? "" : ",", key, json);
  }
  void add(std::string_view key, std::uint64_t value) { add(key, std::to_string(value)); }
  std::string text() const { return "{" + text_ + "\n}\n"; }

 private:
  std::string text_;
};

template <class List, class Format>
std::string array(const List& list, Format format, const char* open, const char* close, const char* separator) {
  std::string text = open;
  for (bool first = true; const auto& item : list) {
    if (!std::exchange(first, false)) text += separator;
    text += format(item);
  }
  return text + close;
}

}  // namespace

std::string statisticsJson(const RunStatistics& s) {
  Object object;
  object.add("framesDrawn", s.frameTimes.count());
  object.add("frameMs",
             fmt::format(R"({{"p50": {}, "p99": {}, "max": {}}})", milliseconds(s.frameTimes.percentile(0.5)),
                         milliseconds(s.frameTimes.percentile(0.99)), milliseconds(s.frameTimes.longest())));
  object.add("msToSettle", s.msToSettle < 0 ? "null" : milliseconds(s.msToSettle));
  object.add("tilesDrawn", s.drawn.tiles);
  object.add("trianglesDrawn", s.drawn.triangles);
  object.add("msaaSamples", static_cast<std::uint64_t>(s.drawn.samples));
  object.add("tilesResident", s.stream.resident);
  object.add("tilesFailed", s.stream.failed);
  object.add("tilesEvicted", s.stream.evicted);
  object.add("requests", s.stream.requests);
  object.add("requestsCancelled", s.stream.cancelled);
  object.add("cacheHits", s.stream.cacheHits);
  object.add("bytesReceived", s.stream.bytesReceived);
  object.add("decodeMs", milliseconds(s.stream.decodeMs));
  object.add("quickDecodes", s.stream.quickDecodes);
  if (s.stream.network.simulated()) {
    object.add("latencyMs", static_cast<std::uint64_t>(s.stream.network.latency.count()));
    object.add("bandwidthBytesPerSecond", s.stream.network.bytesPerSecond);
  }
  object.add("uncoveredPixels", s.uncoveredPixels);
  object.add("skirtPixels", s.skirtPixels);
  object.add("framesCounted", s.framesCounted);
  object.add("rssBytes", s.rssBytes);
  object.add("gpuBytes", s.gpuBytes);
  object.add("residentBytes", s.stream.residentBytes);
  object.add("errorPixels", number(s.errorPixels));
  object.add("placement", quoted(placementName(s.placement)));
  object.add("transition", quoted(transitionName(s.transition)));
  object.add("selfTest", selfTestJson(s.selfTest));
  object.add("renderer", quoted(s.selfTest.renderer));
  object.add("version", quoted(s.selfTest.version));
  object.add("camera", cameraJson(s));
  object.add("server", quoted(s.server));
  object.add("scene", quoted(s.scene));
  object.add("body", quoted(s.body));
  object.add("bodies", array(s.bodies, bodyJson, "[\n    ", "]", ",\n    "));
  object.add("linkMessage", quoted(s.stream.message));
  object.add("effects", array(s.effects, quoted, "[", "]", ", "));
  object.add("constructed",
             array(
                 s.constructed, [](const auto& c) { return fmt::format("{}: {}", quoted(c.first), c.second); }, "{",
                 "}", ", "));
  object.add("points", array(s.points, pointJson, s.points.empty() ? "[" : "[\n    ", "]", ",\n    "));
  return object.text();
}

}  // namespace terrane

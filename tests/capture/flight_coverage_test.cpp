// Whole flights, as their users fly them: no pixel of any frame that must show ground shows background, and no skirt is
// drawn; wholly loaded, and with tiles that come late over a bad network. TERRANE_FLIGHT_FRAMES: of each flight (60).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "client/app/flight_plan.h"
#include "tests/support/both_schemes.h"
#include "tests/support/tile_source.h"
#include "tests/support/view_processes.h"

namespace terrane {
namespace {

using namespace testing_support;

constexpr double kMoonRadiusMeters = 1'737'400;
/// A late tile should come some frames later than it was wanted, and within the flight.
constexpr double kShortestStreamSeconds = 15, kFramesPerSecond = 30;

int frameCount() {
  const char* value = std::getenv("TERRANE_FLIGHT_FRAMES");  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? 60 : std::max(2, std::atoi(value));
}

using SchemeAndFlight = std::tuple<Scheme, const char*>;

class FlightCoverage : public testing::TestWithParam<SchemeAndFlight> {
 protected:
  void SetUp() override { ASSERT_FALSE(server_.url.empty()) << server_.process->errors(); }

  void expectNoHole(const std::string& flight, std::vector<std::string> more) {
    const std::string stats = folder_ / "stats.json";
    more.insert(more.end(), {"--server", server_.url, "--headless", "--size", "640x360",
                             "--camera=-16.4018,21.6039,1e7", "--without", "detail", "--without", "dust", "--flight",
                             flight, "--frames", std::to_string(frameCount()), "--stats", stats});
    const auto outcome = runView(more, std::chrono::seconds(240 + 2 * frameCount()));
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    const std::string json = readFile(stats);
    fmt::print("{} frames, {} requests, {} bytes, {} uncovered pixels\n", jsonNumber(json, "framesDrawn"),
               jsonNumber(json, "requests"), jsonNumber(json, "bytesReceived"), jsonNumber(json, "uncoveredPixels"));
    EXPECT_EQ(jsonNumber(json, "framesDrawn"), frameCount());
    EXPECT_EQ(jsonNumber(json, "framesCounted"), frameCount());
    EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0) << outcome.output;
    EXPECT_EQ(jsonNumber(json, "skirtPixels"), 0);
  }

  /// The built-in flight, in a time that so many frames fill: written as a file.
  std::string inOtherTime(const char* name) {
    auto flight = builtInFlight(name, -16.4018 / 57.29577951308232, 21.6039 / 57.29577951308232, kMoonRadiusMeters);
    EXPECT_TRUE(flight);
    const double seconds = std::max(kShortestStreamSeconds, frameCount() / kFramesPerSecond);
    const double scale = seconds / flight->durationSeconds();
    for (FlightPoint& point : flight->points) point.seconds *= scale;
    std::ofstream(folder_ / "flight.txt") << writeFlight(*flight);
    return folder_ / "flight.txt";
  }

  static const char* flightName() { return std::get<1>(GetParam()); }

  const RunningServer server_{moonScene(std::get<0>(GetParam()))};
  const TemporaryFolder folder_;
};

TEST_P(FlightCoverage, WhollyLoadedItShowsNoHole) { expectNoHole(flightName(), {"--settle"}); }

TEST_P(FlightCoverage, WithLateTilesItShowsNoHole) {
  expectNoHole(inOtherTime(flightName()), {"--latency", "200", "--bandwidth", "2MB/s"});
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, FlightCoverage,
                         testing::Combine(test::bothSchemes(), testing::Values("descent", "ground")),
                         [](const testing::TestParamInfo<SchemeAndFlight>& flight) {
                           return std::string(schemeName(std::get<0>(flight.param))) + "_" + std::get<1>(flight.param);
                         });

}  // namespace
}  // namespace terrane

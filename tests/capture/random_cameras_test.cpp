// Random cameras over the Moon, settled one after another in one session: no pixel that must show ground shows
// background. TERRANE_CAMERAS: how many (12); TERRANE_SEED: of the choice (printed).

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/both_schemes.h"
#include "tests/support/tile_source.h"
#include "tests/support/view_processes.h"

namespace terrane {
namespace {

using namespace testing_support;

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
}

// One pose a line, a second apart. Directions are uniform over the sphere, heights log-uniform, and pitch goes down,
// level, up in turn.
std::string randomFlight(std::uint64_t seed, std::uint64_t count) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::string text = "# terrane flight 1\nabove-ground\n";
  for (std::uint64_t i = 0; i < count; ++i) {
    const double longitude = 360 * unit() - 180, latitude = std::asin(2 * unit() - 1) * 57.29577951308232;
    const double height = 0.2 * std::exp(unit() * std::log(1e7 / 0.2));
    const double heading = 360 * unit() - 180;
    const double pitch = i % 3 == 0 ? -90 + 30 * unit() : i % 3 == 1 ? -10 + 15 * unit() : 5 + 40 * unit();
    text += fmt::format("{} {} {} {} {} {}\n", i, longitude, latitude, height, heading, pitch);
  }
  return text;
}

class RandomCameras : public testing::TestWithParam<Scheme> {};

TEST_P(RandomCameras, ShowNoHoleAtAnyHeightAndPitch) {
  const std::uint64_t count = setting("TERRANE_CAMERAS", 12), seed = setting("TERRANE_SEED", 20260711);
  fmt::print("cameras {}, seed {}\n", count, seed);
  const RunningServer server(moonScene(GetParam()));
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const TemporaryFolder folder;
  std::ofstream(folder / "cameras.txt") << randomFlight(seed, count);
  const auto outcome = runView({"--server", server.url, "--headless", "--size", "640x360", "--flight",
                                folder / "cameras.txt", "--step", "1", "--settle", "--stats", folder / "stats.json"},
                               std::chrono::seconds(60 + 20 * static_cast<long>(count)));
  fmt::print("{}", outcome.output);
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const std::string json = readFile(folder / "stats.json");
  EXPECT_EQ(jsonNumber(json, "framesDrawn"), static_cast<double>(count));
  EXPECT_EQ(jsonNumber(json, "framesCounted"), static_cast<double>(count));
  EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0);
}

INSTANTIATE_TEST_SUITE_P(Schemes, RandomCameras, test::bothSchemes(), test::nameOfScheme);

}  // namespace
}  // namespace terrane

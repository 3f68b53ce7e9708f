// The command line: what a person types, as values; and what is wrong with it, by the flag's name.

#include <gtest/gtest.h>

#include <numbers>

#include "client/app/option_values.h"
#include "client/app/view_options.h"
#include "client/app/view_session.h"
#include "tests/support/view_processes.h"

namespace terrane {
namespace {

constexpr double kDegrees = std::numbers::pi / 180;

std::string noEnvironment(const char*) { return {}; }
std::string homeOnly(const char* name) { return std::string(name) == "HOME" ? "/home/u" : ""; }
std::string cacheHome(const char* name) { return std::string(name) == "XDG_CACHE_HOME" ? "/cache" : "/home/u"; }

ViewOptions parsed(std::vector<std::string> arguments, EnvironmentLookup environment = &noEnvironment) {
  arguments.insert(arguments.begin(), {"--server", "http://h:1"});
  const auto result = parseViewOptions(arguments, environment);
  if (!result) {
    ADD_FAILURE() << result.error().text();
    return {};
  }
  return std::get<ViewOptions>(*result);
}

Error refused(std::vector<std::string> arguments, bool withServer = true) {
  if (withServer) arguments.insert(arguments.begin(), {"--server", "http://h:1"});
  const auto result = parseViewOptions(arguments, &noEnvironment);
  if (result) {
    ADD_FAILURE() << "accepted";
    return {};
  }
  return result.error();
}

TEST(ViewOptions, DefaultsAreThoseThatHelpStates) {
  const ViewOptions options = parsed({});
  EXPECT_FALSE(options.camera);
  EXPECT_FALSE(options.scripted());
  EXPECT_EQ(options.widthPixels, 1280);
  EXPECT_EQ(options.heightPixels, 720);
  EXPECT_EQ(options.errorPixels, 2);
  EXPECT_EQ(options.frameBudgetMs, 0);
  EXPECT_FALSE(options.placement);
  EXPECT_FALSE(options.samples);
  EXPECT_EQ(options.transition, Transition::Morph);
  EXPECT_DOUBLE_EQ(options.verticalFieldOfView, 50 * kDegrees);
}

TEST(ViewOptions, EffectsAreLeftOutByName) {
  EXPECT_TRUE(parsed({}).without.empty());
  EXPECT_EQ(parsed({"--without", "dust", "--without=sun"}).without,
            (std::vector<EffectKind>{EffectKind::Dust, EffectKind::Sun}));
  const Error error = refused({"--without", "snow"});
  EXPECT_EQ(error.field, "--without");
  EXPECT_NE(error.message.find("\"snow\" is no effect"), std::string::npos) << error.message;
}

TEST(ViewOptions, ACameraWestAndSouthOfTheOriginIsNoFlag) {
  const ViewOptions options = parsed({"--camera", "-20.5,-9.25,1e6,370e-1,-12.5"});
  ASSERT_TRUE(options.camera);
  EXPECT_DOUBLE_EQ(options.camera->longitude, -20.5 * kDegrees);
  EXPECT_DOUBLE_EQ(options.camera->latitude, -9.25 * kDegrees);
  EXPECT_DOUBLE_EQ(options.camera->altitudeMeters, 1e6);
  EXPECT_DOUBLE_EQ(options.camera->heading, 37 * kDegrees);
  EXPECT_DOUBLE_EQ(options.camera->pitch, -12.5 * kDegrees);
}

TEST(ViewOptions, ACameraOfThreeNumbersLooksStraightDownNorthUp) {
  const ViewOptions options = parsed({"--camera=1,2,3"});
  ASSERT_TRUE(options.camera);
  EXPECT_EQ(options.camera->heading, 0);
  EXPECT_DOUBLE_EQ(options.camera->pitch, -90 * kDegrees);
}

TEST(ViewOptions, HeadlessSettlesUnlessItFliesOrCountsFrames) {
  EXPECT_TRUE(parsed({"--headless"}).settle);
  EXPECT_FALSE(parsed({"--headless", "--flight", "orbit"}).settle);
  EXPECT_FALSE(parsed({"--headless", "--frames", "9"}).settle);
  EXPECT_TRUE(parsed({"--headless", "--flight", "orbit", "--settle"}).settle);
}

TEST(ViewOptions, FramesSpreadOverAFlightUnlessTheirStepIsGiven) {
  EXPECT_FALSE(parsed({"--headless", "--flight", "ground", "--frames", "9"}).stepGiven);
  EXPECT_TRUE(parsed({"--headless", "--flight", "ground", "--frames", "9", "--step", "0.5"}).stepGiven);
}

TEST(ViewOptions, OnlyAWindowHasADiskCacheOfItself) {
  EXPECT_EQ(parsed({}, &cacheHome).cacheFile, "/cache/terrane/tiles.sqlite");
  EXPECT_TRUE(parsed({}, &cacheHome).cacheIsDefault);
  EXPECT_FALSE(parsed({"--cache", "x.sqlite"}, &cacheHome).cacheIsDefault);
  EXPECT_EQ(parsed({}, &homeOnly).cacheFile, "/home/u/.cache/terrane/tiles.sqlite");
  EXPECT_EQ(parsed({}, &noEnvironment).cacheFile, "");
  EXPECT_EQ(parsed({"--headless"}, &cacheHome).cacheFile, "");
  EXPECT_EQ(parsed({"--headless", "--cache", "x.sqlite"}, &cacheHome).cacheFile, "x.sqlite");
  EXPECT_EQ(parsed({"--cache", "none"}, &cacheHome).cacheFile, "");
}

TEST(ViewOptions, SizesOfMemoryHaveUnits) {
  EXPECT_EQ(parsed({"--memory-budget", "64MiB"}).memoryBudgetBytes, 64u << 20);
  EXPECT_EQ(parsed({"--cache-budget", "1.5GiB"}).cacheBudgetBytes, 3u << 29);
  EXPECT_EQ(parsed({"--cache-budget", "2097152"}).cacheBudgetBytes, 2097152u);
}

TEST(ViewOptions, ABadNetworkHasItsUnits) {
  EXPECT_FALSE(parsed({}).network.simulated());
  EXPECT_FALSE(parsed({"--latency", "0", "--bandwidth", "0"}).network.simulated());
  EXPECT_EQ(parsed({"--latency", "10000"}).network.latency, std::chrono::seconds(10));
  EXPECT_TRUE(parsed({"--latency", "1"}).network.simulated());
  const std::vector<std::pair<std::string, std::uint64_t>> bandwidths{
      {"2MB/s", 2'000'000},       {"500KB/s", 500'000}, {"2MiB/s", 2u << 20},           {"1.5KiB/s", 1536},
      {"1.5GB/s", 1'500'000'000}, {"64000", 64'000},    {"1000GB/s", 1'000'000'000'000}};
  for (const auto& [text, bytesPerSecond] : bandwidths) {
    EXPECT_EQ(parsed({"--bandwidth", text}).network.bytesPerSecond, bytesPerSecond) << text;
    EXPECT_TRUE(parsed({"--bandwidth", text}).network.simulated()) << text;
  }
}

TEST(ViewOptions, EveryPlacementHasItsName) {
  for (const char* name : {"integer", "double-float", "cpu", "float32"}) {
    const ViewOptions options = parsed({"--placement", name});
    ASSERT_TRUE(options.placement) << name;
    EXPECT_EQ(placementName(*options.placement), name);
  }
}

TEST(ViewOptions, SamplesAPixelAreANumberOrOffOrWhatSuitsTheRenderer) {
  EXPECT_FALSE(parsed({"--msaa", "auto"}).samples);
  EXPECT_EQ(parsed({"--msaa", "off"}).samples, 1);
  for (const int samples : {1, 2, 4, 8}) EXPECT_EQ(parsed({"--msaa", std::to_string(samples)}).samples, samples);
}

TEST(ViewOptions, EveryTransitionHasItsName) {
  for (const char* name : {"morph", "blend", "none"})
    EXPECT_EQ(transitionName(parsed({"--transition", name}).transition), name);
}

struct Wrong {
  std::vector<std::string> arguments;
  std::string flag;
};

TEST(ViewOptions, WhatIsWrongIsNamedByItsFlag) {
  const std::vector<Wrong> cases{
      {{"--camera", "1,2"}, "--camera"},
      {{"--camera", "1,2,x"}, "--camera"},
      {{"--camera", "1,2,nan"}, "--camera"},
      {{"--camera", "1,91,3"}, "--camera"},
      {{"--camera", "1,2,3,4,-91"}, "--camera"},
      {{"--camera", "1,2,3,4,5,6"}, "--camera"},
      {{"--camera", ""}, "--camera"},
      {{"--capture", ""}, "--capture"},
      {{"--capture="}, "--capture"},
      {{"--stats", ""}, "--stats"},
      {{"--flight", ""}, "--flight"},
      {{"--cache", ""}, "--cache"},
      {{"--body", ""}, "--body"},
      {{"--record", ""}, "--record"},
      {{"--record", "--headless"}, "--record"},
      {{"--camera", "--headless"}, "--camera"},
      {{"--size", "1280"}, "--size"},
      {{"--size", "1280x"}, "--size"},
      {{"--size", "8x8"}, "--size"},
      {{"--size", "99999x9"}, "--size"},
      {{"--fov", "0"}, "--fov"},
      {{"--fov", "wide"}, "--fov"},
      {{"--error", "0"}, "--error"},
      {{"--error", "nan"}, "--error"},
      {{"--frame-budget", "-1"}, "--frame-budget"},
      {{"--placement", "float64"}, "--placement"},
      {{"--msaa", "3"}, "--msaa"},
      {{"--msaa", "on"}, "--msaa"},
      {{"--transition", "fade"}, "--transition"},
      {{"--frames", "-3"}, "--frames"},
      {{"--frames", "1000000000"}, "--frames"},
      {{"--frames", "1.5"}, "--frames"},
      {{"--step", "0"}, "--step"},
      {{"--time-limit", "0"}, "--time-limit"},
      {{"--cache-budget", "12 parsecs"}, "--cache-budget"},
      {{"--memory-budget", "1KiB"}, "--memory-budget"},
      {{"--latency", "-1"}, "--latency"},
      {{"--latency", "10001"}, "--latency"},
      {{"--latency", "0.5"}, "--latency"},
      {{"--latency", "200ms"}, "--latency"},
      {{"--bandwidth", ""}, "--bandwidth"},
      {{"--bandwidth", "fast"}, "--bandwidth"},
      {{"--bandwidth", "-2MB/s"}, "--bandwidth"},
      {{"--bandwidth", "2MB"}, "--bandwidth"},
      {{"--bandwidth", "2Mbit/s"}, "--bandwidth"},
      {{"--bandwidth", "100"}, "--bandwidth"},
      {{"--bandwidth", "1001GB/s"}, "--bandwidth"},
      {{"--capture", "a-%d.png"}, "--capture"},
      {{"--flight", "orbit", "--capture", "a-%s.png"}, "--capture"},
      {{"--flight", "orbit", "--capture", "%d-%d.png"}, "--capture"},
      {{"--no-such-flag"}, "--no-such-flag"},
      {{"--error"}, "--error"},
      {{"--headless=7"}, "--headless"},
      {{"--settle=true"}, "--settle"},
      {{"--explain="}, "--explain"},
      {{"--version=1"}, "--version"},
      {{"stray"}, "stray"},
  };
  for (const Wrong& wrong : cases) {
    const Error error = refused(wrong.arguments);
    EXPECT_EQ(error.field, wrong.flag) << error.text();
    EXPECT_FALSE(error.message.empty()) << wrong.flag;
    EXPECT_EQ(error.text().find('\n'), std::string::npos) << error.text();
  }
  EXPECT_EQ(refused({}, false).field, "--server");
  EXPECT_EQ(refused({"--server", "--headless"}, false).field, "--server");
  EXPECT_EQ(refused({"--server", "http://"}, false).field, "--server");
}

TEST(ViewOptions, HelpExplainsEveryFlagAndEveryKey) {
  const auto result = parseViewOptions({"--help"}, &noEnvironment);
  ASSERT_TRUE(result);
  const std::string& text = std::get<OptionsText>(*result).text;
  for (const char* word : {"--server",
                           "--body",
                           "--camera",
                           "--above-ground",
                           "--flight",
                           "--record",
                           "--size",
                           "--fov",
                           "--error",
                           "--frame-budget",
                           "--placement",
                           "--msaa",
                           "--transition",
                           "--headless",
                           "--settle",
                           "--capture",
                           "--stats",
                           "--cache",
                           "--cache-budget",
                           "--memory-budget",
                           "--frames",
                           "--step",
                           "--time-limit",
                           "--latency",
                           "--bandwidth",
                           "--explain",
                           "--hud",
                           "--wireframe",
                           "--level-colors",
                           "--version",
                           "Exit status",
                           "F1",
                           "F2",
                           "F3",
                           "F4",
                           "F5",
                           "F12",
                           "Tab",
                           "Home"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
}

TEST(ViewProgram, WrongUsageIsOneLineOnStderrAndStatusTwo) {
  const auto outcome = testing_support::runView({"--server", "http://h:1", "--colour", "red"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.output, "");
  EXPECT_EQ(testing_support::lineCount(outcome.errors), 1u) << outcome.errors;
  EXPECT_NE(outcome.errors.find("--colour"), std::string::npos) << outcome.errors;
}

TEST(ViewProgram, VersionIsOneLineOnStdout) {
  const auto outcome = testing_support::runView({"--version"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.errors, "");
  EXPECT_EQ(outcome.output.rfind("terrane-view ", 0), 0u) << outcome.output;
}

TEST(ViewProgram, AWrongFlightFileIsFoundBeforeAnyServerIsAsked) {
  for (const char* file : {"/no/such/flight", "/dev/null"}) {
    const auto outcome = testing_support::runView({"--server", "http://127.0.0.1:1", "--headless", "--flight", file});
    EXPECT_EQ(outcome.status, 2) << outcome.errors;
    EXPECT_EQ(testing_support::lineCount(outcome.errors), 1u) << outcome.errors;
    EXPECT_EQ(outcome.errors.rfind("terrane-view: --flight: ", 0), 0u) << outcome.errors;
    EXPECT_NE(outcome.errors.find(file), std::string::npos) << outcome.errors;
  }
}

TEST(ViewProgram, WhatTurnsOutToBeWrongLaterIsNamedByItsFlagOnceWithItsStatus) {
  const testing_support::RunningServer server("smooth");
  ASSERT_FALSE(server.url.empty());
  struct Late {
    std::string flag, value;
    int status;
  };
  for (const Late& late : {Late{"--body", "mars", 2}, Late{"--capture", "/no/such/folder/a.png", 1},
                           Late{"--stats", "/no/such/folder/a.json", 1}, Late{"--cache", "/dev/null/tiles", 1}}) {
    const auto outcome =
        testing_support::runView({"--server", server.url, "--headless", "--size", "64x36", late.flag, late.value});
    EXPECT_EQ(outcome.status, late.status) << outcome.errors;
    EXPECT_EQ(testing_support::lineCount(outcome.errors), 1u) << outcome.errors;
    EXPECT_EQ(outcome.errors.rfind("terrane-view: " + late.flag + ": ", 0), 0u) << outcome.errors;
    EXPECT_EQ(outcome.errors.find(late.flag), outcome.errors.rfind(late.flag)) << outcome.errors;
    EXPECT_NE(outcome.errors.find(late.value), std::string::npos) << outcome.errors;
  }
}

TEST(ViewSession, OnlyACacheThatWasAskedForHasToBe) {
  ViewOptions options = parsed({"--cache", "/dev/null/tiles"});
  const auto asked = ViewSession::open(options, nullptr);
  ASSERT_FALSE(asked);
  EXPECT_EQ(asked.error().field, "--cache");
  options.cacheIsDefault = true;
  testing::internal::CaptureStderr();
  EXPECT_TRUE(ViewSession::open(options, nullptr));
  const std::string warning = testing::internal::GetCapturedStderr();
  EXPECT_EQ(testing_support::lineCount(warning), 1u) << warning;
  EXPECT_NE(warning.find("/dev/null/tiles"), std::string::npos) << warning;
}

}  // namespace
}  // namespace terrane

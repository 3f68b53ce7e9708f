// terrane-server and terrane-view as a user runs them: settle, capture, count, fly, record.

#include <gtest/gtest.h>

#include "client/flight/flight_file.h"
#include "client/gl/image.h"
#include "tests/support/view_processes.h"

namespace terrane {
namespace {

using namespace testing_support;

class Viewer : public testing::Test {
 protected:
  static void SetUpTestSuite() { server_ = std::make_unique<RunningServer>("moon"); }
  static void TearDownTestSuite() { server_.reset(); }
  void SetUp() override { ASSERT_FALSE(server_->url.empty()) << server_->process->errors(); }

  ViewOutcome view(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--server", server_->url, "--headless", "--size", "320x180"});
    return runView(arguments);
  }

  static inline std::unique_ptr<RunningServer> server_;
  TemporaryFolder folder_;
};

TEST_F(Viewer, SettlesAtACameraCapturesItAndWritesEveryFigure) {
  const auto outcome =
      view({"--camera", "-10,8,3000000", "--settle", "--capture", folder_ / "a.png", "--stats", folder_ / "a.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");
  const auto image = readPng(folder_ / "a.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 320);
  EXPECT_EQ(image->height, 180);
  const std::string json = readFile(folder_ / "a.json");
  for (const char* key :
       {"framesDrawn",   "frameMs",  "p50",           "p99",      "max",          "msToSettle",      "tilesDrawn",
        "tilesResident", "requests", "bytesReceived", "decodeMs", "quickDecodes", "uncoveredPixels", "skirtPixels",
        "rssBytes",      "gpuBytes", "placement",     "selfTest", "errorPixels",  "transition",      "msaaSamples",
        "camera",        "effects",  "constructed",   "renderer", "points"})
    EXPECT_NE(json.find(std::string(1, '"').append(key).append("\": ")), std::string::npos) << key;
  EXPECT_EQ(jsonNumber(json, "framesDrawn"), 8);
  EXPECT_EQ(jsonNumber(json, "framesCounted"), 8);
  EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0);
  EXPECT_GT(jsonNumber(json, "tilesDrawn"), 0);
  EXPECT_GT(jsonNumber(json, "msToSettle"), 0);
  EXPECT_GE(jsonNumber(json, "bytesReceived"), 1000 * jsonNumber(json, "tilesDrawn"));
}

TEST_F(Viewer, ThePictureOfTheWholeBodyHasABrightDiscAndBlackCorners) {
  const auto outcome = view({"--capture", folder_ / "whole.png"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const auto image = readPng(folder_ / "whole.png");
  ASSERT_TRUE(image);
  const auto brightness = [&](int x, int y) {
    const std::size_t at = 3 * (static_cast<std::size_t>(y) * 320 + static_cast<std::size_t>(x));
    return image->rgb[at] + image->rgb[at + 1] + image->rgb[at + 2];
  };
  EXPECT_LT(brightness(2, 2), 30);
  EXPECT_LT(brightness(317, 177), 30);
  EXPECT_GT(brightness(200, 90), 90);
}

TEST_F(Viewer, SeveralSamplesAPixelAreDrawnAndReported) {
  const auto captured = [&](const std::string& samples) {
    const std::string name = folder_ / samples;
    const auto outcome =
        view({"--camera", "-10,8,6000000", "--msaa", samples, "--capture", name + ".png", "--stats", name + ".json"});
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    return std::pair(readPng(name + ".png").value(), jsonNumber(readFile(name + ".json"), "msaaSamples"));
  };
  const auto [hard, one] = captured("off");
  const auto [smooth, four] = captured("4");
  EXPECT_EQ(one, 1);
  EXPECT_EQ(four, 4);
  EXPECT_GE(captured("8").second, four) << "as many as there are";
  // Down the picture's middle: both go from black to ground at the same row, the smooth one by a shade in between.
  const auto edgeRow = [](const Image& image) {
    std::size_t row = 0;
    while (row + 1 < 180 && image.rgb[3 * (row * 320 + 160)] < 8) ++row;
    return static_cast<int>(row);
  };
  EXPECT_NEAR(edgeRow(hard), edgeRow(smooth), 1);
  EXPECT_NE(hard.rgb, smooth.rgb);
  EXPECT_LT(rmsDifference(hard, smooth), 8);
}

TEST_F(Viewer, AFlightIsFlownWithTheTransitionThatIsAskedFor) {
  for (const std::string transition : {"blend", "none"}) {
    const auto outcome = view({"--camera", "-10,8,0", "--flight", "descent", "--frames", "12", "--step", "0.1",
                               "--transition", transition, "--stats", folder_ / "t.json"});
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    const std::string json = readFile(folder_ / "t.json");
    EXPECT_NE(json.find("\"transition\": \"" + transition + "\""), std::string::npos) << json;
    EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0);
  }
}

TEST_F(Viewer, WireframeAndLevelColoursAreOtherPicturesOfTheSameView) {
  const std::vector<std::string> camera{"--camera", "-10,8,400000,0,-60", "--settle", "--capture"};
  const auto pictureOf = [&](const char* file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = camera;
    arguments.push_back(folder_ / file);
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(view(arguments).status, 0);
    const auto image = readPng(folder_ / file);
    return image ? *image : Image{};
  };
  const auto darkShare = [](const Image& image) {
    std::size_t dark = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
      dark += image.rgb[i] < 12 && image.rgb[i + 1] < 12 && image.rgb[i + 2] < 12 ? 1u : 0u;
    return static_cast<double>(dark) / (static_cast<double>(image.rgb.size()) / 3);
  };
  const Image plain = pictureOf("p.png", {}), wires = pictureOf("w.png", {"--wireframe", "--error", "64"}),
              levels = pictureOf("l.png", {"--level-colors"});
  EXPECT_GT(darkShare(wires), darkShare(plain) + 0.3) << "between the edges it is dark";
  EXPECT_LT(darkShare(levels), darkShare(plain) + 0.01);
  EXPECT_GT(rmsDifference(plain, levels), 10);
}

TEST_F(Viewer, TheSameCameraGivesTheSamePictureTwice) {
  const std::vector<std::string> camera{"--camera", "-10,8,400,30,-30", "--above-ground", "--settle", "--capture"};
  auto first = camera, second = camera;
  first.push_back(folder_ / "1.png");
  second.push_back(folder_ / "2.png");
  ASSERT_EQ(view(first).status, 0);
  ASSERT_EQ(view(second).status, 0);
  const auto a = readPng(folder_ / "1.png"), b = readPng(folder_ / "2.png");
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->rgb, b->rgb);
}

TEST_F(Viewer, AboveGroundStandsThatHighOverTheFinestGround) {
  const auto outcome =
      view({"--camera", "-10,8,2,0,0", "--above-ground", "--error", "8", "--stats", folder_ / "s.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NEAR(jsonNumber(readFile(folder_ / "s.json"), "heightAboveGroundMeters"), 2, 1e-6);
}

TEST_F(Viewer, AFlightIsCapturedAndMeasuredAtEachOfItsPoints) {
  std::ofstream(folder_ / "f.txt")
      << "# terrane flight 1\nabove-ground\n0 -10 8 2000000 0 -90\n1 -10 8 20000 0 -60\n2 -10 8 50 0 -20\n";
  const auto outcome = view({"--flight", folder_ / "f.txt", "--step", "0.5", "--settle", "--error", "4", "--capture",
                             folder_ / "p-%d.png", "--stats", folder_ / "f.json", "--record", folder_ / "r.txt"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(lineCount(outcome.output), 3u) << outcome.output;
  for (const char* name : {"p-1.png", "p-2.png", "p-3.png"}) EXPECT_TRUE(readPng(folder_ / name)) << name;
  const std::string json = readFile(folder_ / "f.json");
  EXPECT_EQ(jsonNumber(json, "framesDrawn"), 5);  // three points and one between each two
  EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0);
  EXPECT_NE(json.find("\"name\": \"2000 km\""), std::string::npos);
  EXPECT_NE(json.find("\"name\": \"50 m\""), std::string::npos);
  const auto recorded = loadFlight(folder_ / "r.txt");
  ASSERT_TRUE(recorded) << recorded.error().text();
  EXPECT_EQ(recorded->points.size(), 5u);
}

TEST_F(Viewer, ExplainNamesTheSceneOfEveryEffectAndWhatItCosts) {
  const auto outcome = view({"--explain"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(outcome.output.find("effect sun: on"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("ms a frame"), std::string::npos) << outcome.output;
  for (const char* constructed : {"effect.sun 1", "effect.detail 1", "effect.dust 1"})
    EXPECT_NE(outcome.output.find(constructed, outcome.output.find("constructed: ")), std::string::npos)
        << outcome.output;
}

TEST_F(Viewer, AnEffectIsLeftOutAsIfTheSceneDidNotNameIt) {
  const auto outcome = view({"--explain", "--without", "dust"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(outcome.output.find("effect dust: off"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("why    --without dust"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("effect.dust"), std::string::npos) << outcome.output;
}

TEST(ViewerOfABareSphere, ConstructsNoEffect) {
  const RunningServer server("smooth");
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const auto outcome = runView({"--server", server.url, "--explain", "--size", "160x90"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_NE(outcome.output.find("effect sun: off"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("effect."), std::string::npos) << outcome.output;
}

TEST_F(Viewer, AFrameBudgetRaisesTheErrorThatAFrameIsDrawnWith) {
  // No machine draws a frame in a hundredth of a millisecond: the controller has to go to its limit.
  const auto outcome = view({"--camera", "-10,8,3000000", "--frame-budget", "0.01", "--settle", "--frames", "60",
                             "--error", "2", "--stats", folder_ / "b.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(jsonNumber(readFile(folder_ / "b.json"), "errorPixels"), 32);
}

TEST_F(Viewer, AnUnknownBodyIsNamedWithThoseThatThereAre) {
  const auto outcome = view({"--body", "mars"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(lineCount(outcome.errors), 1u) << outcome.errors;
  EXPECT_NE(outcome.errors.find("--body"), std::string::npos) << outcome.errors;
  EXPECT_NE(outcome.errors.find("moon"), std::string::npos) << outcome.errors;
}

}  // namespace
}  // namespace terrane

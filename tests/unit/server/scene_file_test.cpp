#include "server/scenes/scene_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "common/tiling/lattice.h"
#include "server/fields/height_field.h"
#include "tests/support/folders.h"

namespace terrane {
namespace {

using testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr std::string_view kScene = R"(
name = "test"
summary = "A test"
[[body]]
name = "ball"
radius = "1737.4 km"
schemes = ["cube"]
seed = 1969
field = "lunar"
[body.lunar]
roughness = 0.5
[[body]]
name = "ball-2"
radius = "250 m"
field = "sphere"
position = ["-384400 km", "12.5 m", "1e10 km"]
[effects.sun]
longitude = "40 deg"
latitude = "-0.5 rad"
)";

std::string replaced(std::string_view what, std::string_view with) {
  std::string text(kScene);
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST(SceneFile, ReadsEveryValueOfASceneInMetresAndRadians) {
  const Result<Scene> scene = parseScene(kScene, "test.toml");
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->name, "test");
  EXPECT_EQ(scene->summary, "A test");
  ASSERT_EQ(scene->bodies.size(), 2u);
  const Body& ball = scene->bodies[0];
  EXPECT_EQ(ball.name, "ball");
  EXPECT_EQ(ball.radiusMeters, 1737400.0) << "exactly: kilometres are not multiplied in binary";
  EXPECT_EQ(ball.seed, 1969u);
  EXPECT_EQ(ball.field, FieldKind::Lunar);
  EXPECT_EQ(ball.fieldParameters.at("roughness"), 0.5);
  EXPECT_EQ(ball.fieldParameters.size(), fieldRow(FieldKind::Lunar).parameters.size())
      << "what is not written has its default";
  EXPECT_THAT(ball.schemes, testing::ElementsAre(Scheme::Cube));
  const Body& second = scene->bodies[1];
  EXPECT_EQ(second.field, FieldKind::Sphere);
  EXPECT_EQ(second.radiusMeters, kMinRadiusMeters);
  EXPECT_EQ(second.seed, 0u);
  EXPECT_EQ(ball.positionScene, glm::dvec3(0.0)) << "the scene's origin where none is written";
  EXPECT_EQ(second.positionScene, glm::dvec3(-384400000, 12.5, kMaxPositionMeters));
  EXPECT_THAT(second.schemes, testing::ElementsAre(Scheme::Cube));
  ASSERT_EQ(scene->effects.size(), 1u);
  EXPECT_EQ(scene->effects[0].kind, EffectKind::Sun);
  EXPECT_EQ(scene->effects[0].parameters.at("longitude"), 40 * kDegree);
  EXPECT_EQ(scene->effects[0].parameters.at("latitude"), -0.5);
}

TEST(SceneFile, ASceneWithoutEffectsCallsForNone) {
  const Result<Scene> scene =
      parseScene(replaced("[effects.sun]\nlongitude = \"40 deg\"\nlatitude = \"-0.5 rad\"\n", ""), "t.toml");
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_TRUE(scene->effects.empty());
}

TEST(SceneFile, AnEmptyTableCallsForAnEffectWithItsDefaults) {
  const Result<Scene> scene = parseScene(replaced("longitude = \"40 deg\"\nlatitude = \"-0.5 rad\"\n", ""), "t.toml");
  ASSERT_TRUE(scene) << scene.error().text();
  ASSERT_EQ(scene->effects.size(), 1u);
  EXPECT_EQ(scene->effects[0].parameters, defaultValues(effectRow(EffectKind::Sun).parameters));
}

TEST(SceneFile, RangesAreInclusiveAtBothEnds) {
  for (const auto& [value, radius] : {std::pair{"250 m", kMinRadiusMeters},
                                      {"250000 mm", kMinRadiusMeters},
                                      {"700000 km", kMaxRadiusMeters},
                                      {"7e5 km", kMaxRadiusMeters}}) {
    const Result<Scene> scene = parseScene(replaced("1737.4 km", value), "t.toml");
    ASSERT_TRUE(scene) << value << ": " << scene.error().text();
    EXPECT_EQ(scene->bodies[0].radiusMeters, radius) << value;
  }
  EXPECT_TRUE(parseScene(replaced("-0.5 rad", "90 deg"), "t.toml"));
  EXPECT_TRUE(parseScene(replaced("-0.5 rad", "-90 deg"), "t.toml"));
}

TEST(SceneFile, EveryShippedSceneIsValidAndBearsItsFilesName) {
  EXPECT_THAT(shippedScenes(), testing::IsSupersetOf({"moon", "moon-ico", "planets", "smooth"}));
  for (const std::string& name : shippedScenes()) {
    const Result<Scene> scene = loadScene(name);
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(scene->name, name);
    EXPECT_FALSE(scene->summary.empty());
  }
}

TEST(SceneFile, SmoothNamesNothingOptional) {
  const Result<Scene> scene = loadScene("smooth");
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scene->effects.empty());
  EXPECT_EQ(scene->bodies.at(0).field, FieldKind::Sphere);
}

TEST(SceneFile, AnUnknownSceneNameListsTheShippedOnes) {
  const Result<Scene> scene = loadScene("mooon");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().field, "--scene");
  EXPECT_THAT(scene.error().message, HasSubstr("did you mean \"moon\"?"));
  EXPECT_THAT(scene.error().message, HasSubstr("moon-ico, moon, planets, smooth"));
}

TEST(SceneFile, AMissingFileADirectoryAndADeviceAreErrors) {
  EXPECT_EQ(loadScene("/nonexistent/scene.toml").error().kind, ErrorKind::NotFound);
  EXPECT_EQ(loadSceneFile(std::filesystem::temp_directory_path()).error().kind, ErrorKind::Io);
  EXPECT_EQ(loadSceneFile("/dev/zero").error().kind, ErrorKind::Io);
}

// Each file's first line holds the message that it must give, after the file's name: "# 5: body[0].radius: ...". One
// that ends in "..." is a beginning: the rest is the TOML library's wording.
class BrokenScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(BrokenScene, GivesOneLineWithFileLineKeyAndWhatIsAllowed) {
  std::ifstream stream(GetParam(), std::ios::binary);
  std::string expected;
  std::getline(stream, expected);
  ASSERT_THAT(expected, testing::StartsWith("# "));
  const std::string fileName = GetParam().string();
  expected = fileName + ":" + expected.substr(2);

  const Result<Scene> scene = loadSceneFile(GetParam());
  ASSERT_FALSE(scene);
  const Error& error = scene.error();
  if (expected.ends_with("...")) {
    expected.resize(expected.size() - 3);
    EXPECT_THAT(error.message, testing::StartsWith(expected));
    EXPECT_GT(error.message.size(), expected.size() + 5);
    EXPECT_EQ(error.kind, ErrorKind::Malformed);
  } else {
    EXPECT_EQ(error.message, expected);
    EXPECT_THAT(error.message, HasSubstr(error.field));
    EXPECT_THAT(error.message, testing::AnyOf(HasSubstr("allowed: "), HasSubstr("expected ")));
  }
  EXPECT_EQ(error.message.find('\n'), std::string::npos);
}

std::vector<std::filesystem::path> brokenScenes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::sourceFolder() + "/tests/unit/server/broken_scenes"))
    files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenScene, testing::ValuesIn(brokenScenes()),
                         [](const auto& test) { return test.param.stem().string(); });

TEST(SceneFile, TheErrorsFieldIsTheKeysPath) {
  const Result<Scene> scene = parseScene(replaced("1737.4 km", "17 parsec"), "moon.toml");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().field, "body[0].radius");
  EXPECT_EQ(scene.error().message,
            "moon.toml:6: body[0].radius: \"17 parsec\" has an unknown unit; allowed: mm, m, km");
}

TEST(SceneFile, ABodyIsTiledByTheCubeOrTheIcosahedron) {
  for (const auto& [text, scheme] : {std::pair("[\"cube\"]", Scheme::Cube), std::pair("[\"ico\"]", Scheme::Ico)}) {
    const Result<Scene> scene = parseScene(replaced("[\"cube\"]", text), "t.toml");
    ASSERT_TRUE(scene) << scene.error().text();
    EXPECT_EQ(scene->bodies.at(0).schemes, std::vector{scheme});
  }
}

TEST(SceneFile, TwoSchemesAtOnceAreUnsupportedRatherThanWrong) {
  const Result<Scene> scene = parseScene(replaced("[\"cube\"]", "[\"ico\", \"cube\"]"), "t.toml");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::Unsupported);
  EXPECT_EQ(scene.error().field, "body[0].schemes[1]");
}

TEST(SceneFile, MoonIcoIsTheMoonOnOtherTiles) {
  const Result<Scene> moon = loadScene("moon"), ico = loadScene("moon-ico");
  ASSERT_TRUE(moon && ico);
  Body body = ico->bodies.at(0);
  EXPECT_EQ(body.schemes, std::vector{Scheme::Ico});
  body.schemes = moon->bodies.at(0).schemes;
  EXPECT_EQ(body.radiusMeters, moon->bodies.at(0).radiusMeters);
  EXPECT_EQ(body.field, moon->bodies.at(0).field);
  EXPECT_EQ(body.fieldParameters, moon->bodies.at(0).fieldParameters);
  EXPECT_EQ(body.seed, moon->bodies.at(0).seed);
}

TEST(SceneFile, BytesThatAreNotUtf8AreRefusedWithTheirLine) {
  for (const std::string_view bytes : {"\xff", "\xc3", "\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82"}) {
    const Result<Scene> scene = parseScene(replaced("A test", bytes), "t.toml");
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().kind, ErrorKind::Malformed);
    EXPECT_THAT(scene.error().message, testing::StartsWith("t.toml:3: not UTF-8"));
  }
  EXPECT_TRUE(parseScene(replaced("A test", "\xe2\x82\xac \xf0\x9f\x8c\x95 \xc3\xa4"), "t.toml"));
}

TEST(SceneFile, AFileBeyondTheLimitIsRefusedBeforeItIsParsed) {
  const Result<Scene> scene = parseScene(std::string(kScene) + std::string(kMaxSceneFileBytes, '\n'), "t.toml");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::TooLarge);
}

TEST(SceneFile, DeepNestingOfEveryKindIsRefusedAndNotFollowed) {
  std::string dotted = "a", tables = "x = ", arrays = "x = ";
  for (int i = 0; i < 400; ++i) dotted += ".a";
  for (int i = 0; i < 100; ++i) tables += "{a = ", arrays += "[";
  for (const std::string& text : {dotted + " = 1", "[" + dotted + "]", tables, arrays, std::string(60000, '[')})
    EXPECT_FALSE(parseScene(text, "t.toml")) << text.substr(0, 20);
}

// Each of these breaks an assumption that the TOML library makes of its own state.
TEST(SceneFile, WhatTheLibraryTakesForImpossibleIsASyntaxError) {
  for (const std::string_view text :
       {"[.",   "[.a]",      "[=",     "[[.]]", "[a.",    "a.",        "a.=1",         "a.b",
        "=",    "a=",        "a={.",   "a={b",  "a=[",    "[\"",       "\"",           "a='",
        "[a]]", "a = 1979-", "a = 0x", "a = +", "a = 1e", "a = \"\\u", "\xef\xbb\xbf["}) {
    const Result<Scene> scene = parseScene(text, "t.toml");
    ASSERT_FALSE(scene) << text;
    EXPECT_EQ(scene.error().kind, ErrorKind::Malformed) << text;
  }
}

// What a body's ground can reach counts, not its reference sphere; farther apart than that, a body may be anywhere.
TEST(SceneFile, BodiesMayStandAsCloseAsTheirHighestGroundLets) {
  const auto apart = [](double meters) {
    return parseScene(fmt::format("name = \"t\"\n[[body]]\nname = \"a\"\nradius = \"10 km\"\nfield = \"lunar\"\n"
                                  "[[body]]\nname = \"b\"\nradius = \"5 km\"\nfield = \"sphere\"\n"
                                  "position = [\"0 m\", \"{} m\", \"0 m\"]\n",
                                  meters),
                      "t.toml");
  };
  Body lunar;
  lunar.radiusMeters = 10'000;
  lunar.field = FieldKind::Lunar;
  lunar.fieldParameters = defaultValues(fieldRow(FieldKind::Lunar).parameters);
  const double highest = makeHeightField(lunar, SimdPath::Default)->heightRange().maxMeters;
  ASSERT_GT(highest, 1);
  EXPECT_TRUE(apart(15'001 + highest));
  const Result<Scene> touching = apart(14'999 + highest);
  ASSERT_FALSE(touching) << "the spheres are clear of each other, the hills are not";
  EXPECT_EQ(touching.error().field, "body[1].position");
}

TEST(SceneFile, TooManyBodiesAreRefused) {
  std::string text = "name = \"many\"\n";
  for (std::size_t i = 0; i <= kMaxSceneBodies; ++i)
    text += "[[body]]\nname = \"b" + std::to_string(i) + "\"\nradius = \"1 km\"\nfield = \"sphere\"\n";
  const Result<Scene> scene = parseScene(text, "t.toml");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::TooLarge);
}

// Every prefix and every single changed byte of a valid file: an answer, never a crash.
TEST(SceneFile, CutAndChangedFilesGiveAnAnswer) {
  std::size_t valid = 0;
  for (std::size_t length = 0; length < kScene.size(); ++length) {
    const Result<Scene> scene = parseScene(kScene.substr(0, length), "t.toml");
    if (!scene) {
      EXPECT_FALSE(scene.error().message.empty());
    }
  }
  for (std::size_t i = 0; i < kScene.size(); ++i) {
    for (const char c : {'\0', '"', '[', '.', '=', '\n', '\xff', '9'}) {
      std::string text(kScene);
      text[i] = c;
      valid += parseScene(text, "t.toml").has_value();
    }
  }
  EXPECT_GT(valid, 0u);
}

}  // namespace
}  // namespace terrane

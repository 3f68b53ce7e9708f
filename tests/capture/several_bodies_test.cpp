// Several bodies in one picture: each where geometry puts it, whole, before what is farther and behind what is nearer,
// and the same from whichever body's frame the camera is known in.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <thread>
#include <vector>

#include "client/app/body_view.h"
#include "client/app/view_session.h"
#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "common/view/body_frames.h"
#include "server/scenes/scene_file.h"
#include "tests/capture/gl_fixture.h"
#include "tests/support/require.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/view_processes.h"

namespace terrane {
namespace {

using namespace testing_support;

constexpr int kWidth = 480, kHeight = 270;
constexpr double kFieldOfView = 50 * kDegree;

/// Squared distance of a pixel's ray from a centre, over the squared distance along it; the camera looks there.
double offRay(const Camera& camera, int x, int y, const glm::dvec3& centre) {
  const double perPixel = 1 / pixelsPerRadian(camera);
  const glm::dvec3 ray = glm::normalize(camera.right * ((x + 0.5 - 0.5 * kWidth) * perPixel) +
                                        camera.up * ((0.5 * kHeight - y - 0.5) * perPixel) - camera.backward);
  const double along = glm::dot(centre, ray);
  return along > 0 ? glm::length(centre - along * ray) : std::numeric_limits<double>::infinity();
}

std::array<std::uint8_t, 3> pixel(const Image& image, int x, int y) {
  const std::size_t at = 3 * static_cast<std::size_t>(y * image.width + x);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}
bool isSky(const Image& image, int x, int y) { return pixel(image, x, y) == std::array<std::uint8_t, 3>{}; }

class SeveralBodiesTest : public GlTest {
 protected:
  static ViewOptions optionsFor(const std::string& url) {
    ViewOptions options;
    options.serverUrl = url;
    options.verticalFieldOfView = kFieldOfView;
    return options;
  }
  static void settle(ViewSession& session, const ViewSession::View& view) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (!session.update(view, kUnlimitedUpload).settled && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
  }
};

// The shipped scene from the place that its file names, as a user sees it.
TEST_F(SeveralBodiesTest, EveryBodyOfTheShippedSceneIsWhereGeometryPutsItAndWhole) {
  const RunningServer server("planets");
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const TemporaryFolder folder;
  const auto outcome =
      runView({"--server", server.url, "--headless", "--settle", "--size", "480x270", "--camera=0,0,2400000,90,-25",
               "--cache", "none", "--capture", folder / "p.png", "--stats", folder / "p.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(jsonNumber(readFile(folder / "p.json"), "uncoveredPixels"), 0);
  EXPECT_EQ(jsonNumber(readFile(folder / "p.json"), "skirtPixels"), 0);
  const Image image = require(readPng(folder / "p.png"));

  const Scene scene = require(loadScene("planets"));
  const Camera camera = cameraFromPose({0, 0, 2.4e6, 90 * kDegree, -25 * kDegree}, scene.bodies[0].radiusMeters,
                                       kFieldOfView, kWidth, kHeight);
  std::vector<int> discPixels(scene.bodies.size());
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      bool mayShow = false, mustShow = false;
      for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
        const Body& body = scene.bodies[k];
        const glm::dvec3 centre = body.positionScene - camera.positionBody;
        // Ground of the shipped scene's fields lies within a twentieth of the radius; a pixel and a half for its edges.
        const double pixels = 1.5 * glm::length(centre) / pixelsPerRadian(camera), off = offRay(camera, x, y, centre);
        mayShow = mayShow || off < 1.05 * body.radiusMeters + pixels;
        mustShow = mustShow || off < 0.95 * body.radiusMeters - pixels;
        discPixels[k] += off < body.radiusMeters;
      }
      if (mustShow || !mayShow) {
        ASSERT_EQ(isSky(image, x, y), !mayShow) << x << ", " << y;
      }
    }
  }
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) EXPECT_GT(discPixels[k], 40) << scene.bodies[k].name;
}

// Two bodies of equal tile names, drawn together and each alone.
TEST_F(SeveralBodiesTest, TheNearerHidesTheFartherPixelByPixel) {
  TileSource& moonTiles = moon(Scheme::Ico);
  TileSource smoothTiles("smooth");
  const SelectionBody &moonBody = moonTiles.selection(), &smoothBody = smoothTiles.selection();
  const Camera over = cameraFromPose({0.4, 0.2, 6e6, 1, -1.5}, moonBody.radiusMeters, kFieldOfView, kWidth, kHeight);
  const glm::dvec3 ahead = -over.backward;
  int hiddenByMoon = 0, hiddenBySmooth = 0;
  for (const double alongMeters : {2.6e6, 2.4e7}) {  // before the Moon, and behind it
    const glm::dvec3 place = over.positionBody + ahead * alongMeters + over.right * (0.22 * alongMeters);
    const Camera overSmooth = cameraOverOther(over, glm::dvec3(0), place, smoothBody.radiusMeters);
    auto renderer = makeRenderer(moonSunlight());
    const auto upload = [&](TileSource& source, const Camera& camera, std::size_t body) {
      const std::vector<FacePath> paths = source.settledTiles(camera, 2);
      for (const FacePath& path : paths) renderer->upload(source.tile(path), body);
      return asTheyAre(paths);
    };
    const auto moonDrawn = upload(moonTiles, over, 0), smoothDrawn = upload(smoothTiles, overSmooth, 1);
    const auto pictureOf = [](std::size_t body, const Camera& camera, const std::vector<DrawnTile>& tiles,
                              const SelectionBody& shape) {
      return BodyPicture{body,
                         camera,
                         tiles,
                         shape.radiusMeters,
                         shape.radiusMeters + shape.heights.maxMeters,
                         shape.occluderRadiusMeters,
                         shape.scheme};
    };
    const BodyPicture theMoon = pictureOf(0, over, moonDrawn, moonBody);
    const BodyPicture theSmooth = pictureOf(1, overSmooth, smoothDrawn, smoothBody);
    const RenderTarget target = require(RenderTarget::create(kWidth, kHeight));
    const auto draw = [&](std::vector<BodyPicture> bodies) {
      target.bind();
      renderer->draw(bodies, {.skirts = true});
      target.bindForReading();
      return readFramebuffer(kWidth, kHeight);
    };
    const Image both = draw({theMoon, theSmooth}), turned = draw({theSmooth, theMoon});
    const Image moonAlone = draw({theMoon}), smoothAlone = draw({theSmooth});
    EXPECT_EQ(both.rgb, turned.rgb) << "whichever is named first";
    const bool smoothIsNearer = alongMeters < 6e6;
    const Image &near = smoothIsNearer ? smoothAlone : moonAlone, &far = smoothIsNearer ? moonAlone : smoothAlone;
    const std::vector<BodyPicture> pictures{theMoon, theSmooth};
    EXPECT_EQ(renderer->countCoverage(pictures, {.skirts = true}).uncovered, 0u);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        ASSERT_EQ(pixel(both, x, y), pixel(isSky(near, x, y) ? far : near, x, y)) << x << ", " << y;
        if (!isSky(near, x, y) && !isSky(far, x, y)) ++(smoothIsNearer ? hiddenBySmooth : hiddenByMoon);
      }
    }
  }
  EXPECT_GT(hiddenBySmooth, 500) << "they overlap in the picture";
  EXPECT_GT(hiddenByMoon, 500);
}

TEST_F(SeveralBodiesTest, ABodyThatIsNotDrawnCountsAsUncovered) {
  TileSource& tiles = moon();
  const SelectionBody& body = tiles.selection();
  const Camera camera = cameraFromPose({0, 0, 4e6, 0, -1.5}, body.radiusMeters, kFieldOfView, kWidth, kHeight);
  auto renderer = makeRenderer();
  const BodyPicture nothing{0, camera, {}, body.radiusMeters, body.radiusMeters, body.occluderRadiusMeters};
  EXPECT_GT(renderer->countCoverage(std::array{nothing}, {}).uncovered, 1000u);
}

TEST_F(SeveralBodiesTest, AChangeOfAnchorDoesNotChangeThePicture) {
  const RunningServer server("planets");
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const auto session = require(ViewSession::open(optionsFor(server.url), [] {}));
  while (!require(session->ready())) std::this_thread::yield();
  ASSERT_EQ(session->body().name, "planet");
  // Over the planet by its pose; some kilometres from the pebble, which fills much of the picture, before the rock.
  const Scene scene = require(loadScene("planets"));
  const auto place = [&](std::string_view name) {
    return std::ranges::find(scene.bodies, name, &Body::name)->positionScene;
  };
  const glm::dvec3 pebble = place("pebble"), towards = glm::normalize(place("rock") - pebble);
  Camera camera;
  camera.positionBody = pebble - 2000.0 * towards;
  camera.altitudeMeters = glm::length(camera.positionBody) - scene.bodies[0].radiusMeters;
  // A little to the side: the planet's level is not the pebble's.
  const glm::dvec3 up = glm::normalize(camera.positionBody);
  camera.backward = -glm::normalize(towards + 0.15 * glm::normalize(glm::cross(towards, up)));
  camera.right = glm::normalize(glm::cross(up, camera.backward));
  camera.up = glm::cross(camera.backward, camera.right);
  const RenderTarget target = require(RenderTarget::create(kWidth, kHeight));
  const auto draw = [&] {
    target.bind();
    session->draw();
    target.bindForReading();
    return readFramebuffer(kWidth, kHeight);
  };
  ViewSession::View view{
      .pose = poseFromCamera(camera), .widthPixels = kWidth, .heightPixels = kHeight, .seconds = 1e9};
  settle(*session, view);
  const Image before = draw();
  ASSERT_TRUE(session->anchorNearest());
  EXPECT_EQ(session->body().name, "pebble");
  EXPECT_FALSE(session->anchorNearest()) << "it is the nearest now";
  EXPECT_GT(std::abs(session->pose().roll), 0.5) << "the other body's level is another";
  view.pose = session->pose();
  settle(*session, view);
  const Image after = draw();
  // Nanometres move no more than an edge's pixel here and there.
  std::size_t differing = 0, lit = 0;
  for (std::size_t i = 0; i < before.rgb.size(); i += 3) {
    differing += std::abs(int{before.rgb[i]} - int{after.rgb[i]}) > 2;
    lit += before.rgb[i] > 40;
  }
  EXPECT_GT(lit, 10'000u) << "there is something to see";
  EXPECT_LT(differing, 20u);
  session->anchorFirst();
  EXPECT_EQ(session->body().name, "planet");
  EXPECT_NEAR(session->pose().altitudeMeters, camera.altitudeMeters, 1e-6);
}

TEST_F(SeveralBodiesTest, ABodySmallerThanAPixelCostsNothing) {
  const RunningServer server("planets");
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const TemporaryFolder folder;
  // Settled, and in a flight, which asks for what lies beside the picture too.
  for (const std::vector<std::string>& way : {std::vector<std::string>{"--settle"}, {"--frames", "30"}}) {
    std::vector<std::string> arguments{
        "--server", server.url, "--headless", "--size",         "480x270", "--camera=180,0,20000000",
        "--cache",  "none",     "--stats",    folder / "p.json"};
    arguments.insert(arguments.end(), way.begin(), way.end());
    const auto outcome = runView(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.errors;
    const std::string json = readFile(folder / "p.json");
    const std::string pebble = json.substr(json.find("{\"name\": \"pebble\""));
    EXPECT_LT(jsonNumber(pebble, "diameterPixels"), kLeastDiameterPixels);
    EXPECT_EQ(jsonNumber(pebble, "tilesDrawn"), 0) << way.front();
    EXPECT_EQ(jsonNumber(pebble, "tilesResident"), 0) << way.front();
  }
}

}  // namespace
}  // namespace terrane

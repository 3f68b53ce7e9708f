// The surface is closed: no pixel whose ray meets the body's lowest sphere shows background, whether skirts hang
// between levels or edges are morphed and stitched to coarser ones. The controls leave out a tile, or the stitching.
// TERRANE_COVERAGE_CAMERAS: how many cameras (12).

#include "client/render/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/tiling/tile_at.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/stitched_tiles.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr double kErrorPixels = 2;

class CoverageTest : public GlTestOfSchemes {
 protected:
  static CoverageCount count(TileRenderer& renderer, const Camera& camera, const std::vector<FacePath>& paths,
                             Placement placement) {
    for (const FacePath& path : paths) renderer.upload(tiles().tile(path));
    return renderer.countCoverage(camera, paths, {.placement = placement, .skirts = true},
                                  tiles().selection().occluderRadiusMeters);
  }
};

int cameraCount() {
  const char* value = std::getenv("TERRANE_COVERAGE_CAMERAS");  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? 12 : std::atoi(value);
}

TEST_P(CoverageTest, EverySettledViewIsClosedFromTwentyCentimetresToTenThousandKilometres) {
  constexpr unsigned kSeed = 20260801;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::printf("seed %u, %d cameras\n", kSeed, cameraCount());
  std::uint64_t skirt = 0, unstitched = 0;
  for (int i = 0; i < cameraCount(); ++i) {
    const double altitude = 0.2 * std::pow(1e7 / 0.2, unit(random));
    const double pitch[] = {-90, -20, 5};  // down, level, up
    ViewPose pose{(2 * unit(random) - 1) * 180 * kDegree, std::asin(2 * unit(random) - 1), altitude,
                  2 * unit(random) * 3.14159, pitch[i % 3] * kDegree};
    SCOPED_TRACE(testing::Message() << "camera " << i << ": longitude " << pose.longitude << ", latitude "
                                    << pose.latitude << ", " << altitude << " m above ground, heading " << pose.heading
                                    << ", pitch " << pose.pitch);
    TileSource source(moonScene(GetParam()));  // of its own: a full run would keep too many tiles
    const Camera camera = source.cameraAboveGround(pose, kWidth, kHeight);
    const std::vector<FacePath> paths = source.settledTiles(camera, kErrorPixels);
    auto renderer = makeRenderer();
    for (const FacePath& path : paths) {
      renderer->upload(source.tile(path));
      if (path.level() > 0) renderer->upload(source.tile(path.parent()));
    }
    const double lowest = source.selection().occluderRadiusMeters;
    for (const Placement placement : {Placement::Integer, Placement::DoubleFloat, Placement::Cpu}) {
      const CoverageCount skirted =
          renderer->countCoverage(camera, paths, {.placement = placement, .skirts = true}, lowest);
      const CoverageCount stitched =
          renderer->countCoverage(camera, stitchedTiles(paths), {.placement = placement}, lowest);
      EXPECT_EQ(skirted.uncovered, 0u) << placementName(placement);
      const CoverageCount onTheirWay = renderer->countCoverage(
          camera, tilesOnTheirWay(paths, kSeed + static_cast<unsigned>(i)), {.placement = placement}, lowest);
      EXPECT_EQ(stitched.uncovered, 0u) << placementName(placement) << ", without skirts";
      EXPECT_EQ(onTheirWay.uncovered, 0u) << placementName(placement) << ", in the middle of transitions";
      EXPECT_EQ(stitched.skirt, 0u);
      skirt += skirted.skirt;
    }
    unstitched += renderer->countCoverage(camera, paths, {}, lowest).uncovered;
  }
  std::printf("pixels that show a skirt, over all: %llu; control, neither skirts nor stitching: %llu uncovered\n",
              static_cast<unsigned long long>(skirt), static_cast<unsigned long long>(unstitched));
  EXPECT_GT(unstitched, 0u) << "the control";
}

TEST_P(CoverageTest, LeavingOutATileIsSeen) {
  const Camera camera = tiles().cameraAboveGround({0.5, 0.3, 500.0, 0, -90 * kDegree}, kWidth, kHeight);
  const std::vector<FacePath> paths = tiles().settledTiles(camera, kErrorPixels);
  auto renderer = makeRenderer();
  const CoverageCount whole = count(*renderer, camera, paths, Placement::Integer);
  EXPECT_EQ(whole.uncovered, 0u);
  // The tile under the camera.
  std::vector<FacePath> holed;
  for (const FacePath& path : paths)
    if (path != tileAt(GetParam(), camera.positionBody, path.level())) holed.push_back(path);
  ASSERT_EQ(holed.size() + 1, paths.size());
  const CoverageCount open =
      renderer->countCoverage(camera, holed, {.skirts = true}, tiles().selection().occluderRadiusMeters);
  EXPECT_GT(open.uncovered, 500u);
}

TEST_P(CoverageTest, TheBaselinePathCountsTheSame) {
  const Camera camera = tiles().cameraAboveGround({-1.0, 0.7, 50.0, 2.0, -10 * kDegree}, kWidth, kHeight);
  const std::vector<FacePath> paths = tiles().settledTiles(camera, kErrorPixels);
  auto baseline = makeRenderer({}, {.forceBaseline = true});
  EXPECT_EQ(count(*baseline, camera, paths, Placement::Integer).uncovered, 0u);
  for (const FacePath& path : paths) baseline->upload(tiles().tile(path.parent()));
  EXPECT_EQ(
      baseline->countCoverage(camera, stitchedTiles(paths), {}, tiles().selection().occluderRadiusMeters).uncovered, 0u)
      << "without skirts";
}

INSTANTIATE_TEST_SUITE_P(Schemes, CoverageTest, test::bothSchemes(), test::nameOfScheme);

Camera plainCamera(double altitudeMeters, double pitch) {
  return cameraFromPose({0.4, -0.2, altitudeMeters, 0.7, pitch}, 1737400, 0.9, kWidth, kHeight);
}

TEST(Coverage, AnEmptyPictureCountsTheDiscOfTheBody) {
  const double altitude = 1e7, lowest = 1737400;
  const Camera camera = plainCamera(altitude, -90 * kDegree);
  const std::vector<std::uint8_t> nothing(kWidth * kHeight, kCoverageNone);
  const CoverageCount count = countCoveragePixels(camera, nothing, lowest);
  const double distance = altitude + lowest;
  const double radiusPixels = pixelsPerRadian(camera) * lowest / std::sqrt(distance * distance - lowest * lowest);
  const double disc = 3.14159265358979 * radiusPixels * radiusPixels;
  EXPECT_NEAR(static_cast<double>(count.uncovered), disc, 0.01 * disc);
  const std::vector<std::uint8_t> surface(kWidth * kHeight, kCoverageSurface);
  EXPECT_EQ(countCoveragePixels(camera, surface, lowest).uncovered, 0u);
  const std::vector<std::uint8_t> skirts(kWidth * kHeight, 128);
  EXPECT_EQ(countCoveragePixels(camera, skirts, lowest).skirt, static_cast<std::uint64_t>(kWidth * kHeight));
}

TEST(Coverage, AMillimetreAboveTheLowestSphereTheHorizonIsInTheMiddleOfALevelView) {
  const std::vector<std::uint8_t> nothing(kWidth * kHeight, kCoverageNone);
  // Half the rows look below the horizon, which a subtraction of squared distances would misplace.
  EXPECT_EQ(countCoveragePixels(plainCamera(0.001, 0), nothing, 1737400).uncovered,
            static_cast<std::uint64_t>(kWidth * kHeight / 2));
  EXPECT_EQ(countCoveragePixels(plainCamera(0.001, 80 * kDegree), nothing, 1737400).uncovered, 0u) << "looking up";
  EXPECT_EQ(countCoveragePixels(plainCamera(-1, 80 * kDegree), nothing, 1737400).uncovered,
            static_cast<std::uint64_t>(kWidth * kHeight))
      << "inside the sphere every ray meets it";
}

}  // namespace
}  // namespace terrane

// Selection over the lunar terrain comes to an end: a viewer that makes resident whatever is asked for soon has all of
// it, and then draws exactly that, as fine as it is to be, however low the camera flies.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <unordered_map>

#include "client/controls/camera_controls.h"
#include "common/view/tile_selection.h"
#include "proto/resident_tile.h"
#include "server/build/tile_builder.h"
#include "tests/support/moon_body.h"
#include "tests/support/sanitizers.h"

namespace terrane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFieldOfView = 0.9;
/// Every round knows one level more at least; with a few levels asked for ahead, most views take seven or eight.
constexpr int kMostRounds = 20;
constexpr int kLowCameras = test::kSanitized ? 2 : 10;

/// A viewer of the moon without a budget: what was asked for once stays resident.
class PatientViewer {
 public:
  const SelectionBody& body() const { return builder_.info().selection; }

  double groundMeters(double longitude, double latitude) const {
    const glm::dvec3 direction = directionOf(longitude, latitude);
    SurfaceSamples samples;
    field_->evaluate({&direction.x, &direction.y, &direction.z, 1, 1}, 0.0, samples);
    return samples.heightMeters[0];
  }

  TileSelection select(const Camera& camera, const SelectionSettings& settings) const {
    return selectTiles(
        camera, body(),
        [this](const FacePath& path) {
          const auto found = residents_.find(path);
          return found == residents_.end() ? nullptr : &found->second;
        },
        settings);
  }

  /// True if anything was not there yet.
  bool load(const std::vector<WantedTile>& wanted) {
    const std::size_t before = residents_.size();
    for (const WantedTile& tile : wanted) {
      if (residents_.contains(tile.path)) continue;
      const Result<Tile> built = builder_.buildMesh(tile.path);
      if (built.has_error()) {
        ADD_FAILURE() << tile.path.text() << ": " << built.error().text();
        return false;
      }
      residents_.emplace(tile.path, residentTile(*built, builder_.body().radiusMeters));
    }
    return residents_.size() != before;
  }

 private:
  TileBuilder builder_{testMoon(), {}, bestSimdPath()};
  std::unique_ptr<const HeightField> field_ = makeHeightField(testMoon(), bestSimdPath());
  std::unordered_map<FacePath, ResidentTile> residents_;
};

std::vector<FacePath> sorted(std::vector<FacePath> paths) {
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<FacePath> leavesOf(const TileSelection& selection) {
  std::vector<FacePath> leaves;
  for (const WantedTile& tile : selection.wanted)
    if (tile.leaf) leaves.push_back(tile.path);
  return sorted(leaves);
}

void expectCompletion(PatientViewer& viewer, const ViewPose& pose) {
  const Camera camera = cameraFromPose(pose, viewer.body().radiusMeters, kFieldOfView, 640, 360);
  SelectionSettings settings;
  settings.errorPixels = 4;
  TileSelection selection = viewer.select(camera, settings);
  int rounds = 1;
  for (; viewer.load(selection.wanted) && rounds < kMostRounds; ++rounds) selection = viewer.select(camera, settings);
  EXPECT_LT(rounds, kMostRounds) << "there is always more to ask for";
  EXPECT_TRUE(selection.complete) << "all is there after " << rounds << " rounds, but not drawn";
  EXPECT_FALSE(selection.draw.empty());
  EXPECT_EQ(sorted(selection.draw), leavesOf(selection));
  for (const WantedTile& tile : selection.wanted) {
    if (!tile.leaf || tile.path.level() == viewer.body().maxLevel) continue;
    EXPECT_LE(tile.screenErrorPixels, settings.errorPixels) << tile.path.text() << " waits for ever to be refined";
  }
}

double radians(double degrees) { return degrees * kPi / 180; }

TEST(SelectionConvergence, RefinesWhereCoarserNeighboursOnceHeldFinerTilesBackForEver) {
  PatientViewer viewer;
  expectCompletion(viewer, {.longitude = radians(-20.1),
                            .latitude = radians(9.6),
                            .altitudeMeters = -1573.753,
                            .heading = 0.4,
                            .pitch = radians(-12)});
}

TEST(SelectionConvergence, CompletesForLowCameras) {
  for (int i = 0; i < kLowCameras; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(20'000 + i));
    std::uniform_real_distribution<double> unit(0, 1);
    ViewPose pose;
    pose.longitude = (2 * unit(random) - 1) * kPi;
    pose.latitude = std::asin(2 * unit(random) - 1);
    pose.heading = (2 * unit(random) - 1) * kPi;
    pose.pitch = radians(-20 * unit(random));
    const double aboveGroundMeters = 0.5 * std::pow(100.0, unit(random));
    PatientViewer viewer;
    pose.altitudeMeters = viewer.groundMeters(pose.longitude, pose.latitude) + aboveGroundMeters;
    SCOPED_TRACE(::testing::Message() << "camera " << i << ", " << aboveGroundMeters << " m above ground");
    expectCompletion(viewer, pose);
  }
}

}  // namespace
}  // namespace terrane

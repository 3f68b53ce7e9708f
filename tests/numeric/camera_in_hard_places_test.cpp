// Cameras where arithmetic has nothing to hold on to: exactly in a corner of the cube, on a pole, at the planet's
// centre, so far out that squares overflow, nowhere at all. What is selected is finite, disjoint and bounded, always.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <string>
#include <unordered_set>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "common/view/horizon.h"
#include "common/view/level_of_detail.h"
#include "common/view/tile_selection.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

constexpr double kMoon = kMoonRadiusMeters;
constexpr double kPi = std::numbers::pi;
constexpr HeightRange kHeights{-9000, 9000};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SelectionBody moon() { return selectionMoon(24, kHeights); }

struct Place {
  std::string name;
  Camera camera;
};

Camera cameraAt(const glm::dvec3& positionBody, double altitudeMeters, double pitch) {
  Camera camera = cameraFromPose({0.3, 0.2, 0, 1, pitch}, kMoon, 0.9, 1280, 720);
  camera.positionBody = positionBody;
  camera.altitudeMeters = altitudeMeters;
  return camera;
}

std::vector<Place> hardPlaces() {
  std::vector<Place> places;
  for (const double pitch : {-kPi / 2, -0.5, 0.0}) {
    for (int corner = 0; corner < 8; ++corner) {
      // The three components are equal to the bit, so that no face is nearer than another.
      const glm::dvec3 direction =
          cubeDirection((corner & 1) != 0 ? 0 : 1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
      for (const double altitude : {-9000.0, 0.0, 1e-3, 10.0, 1e7})
        places.push_back({"corner", cameraAt(direction * (kMoon + altitude), altitude, pitch)});
    }
    for (const double z : {kMoon + 1, kMoon, kMoon - 9000, -kMoon})
      places.push_back({"pole", cameraAt({0, 0, z}, std::fabs(z) - kMoon, pitch)});
    places.push_back({"centre", cameraAt({0, 0, 0}, -kMoon, pitch)});
    places.push_back({"a denormal off the centre", cameraAt({5e-324, -5e-324, 0}, -kMoon, pitch)});
    for (const double far : {1e15, 1e100, 1e153, 1e155, 1e200, 1e300, std::numeric_limits<double>::max()}) {
      places.push_back({"far out", cameraAt({far, 0, 0}, far, pitch)});
      places.push_back({"far out, looking back", cameraFromPose({1, 1, far, 0, -kPi / 2}, kMoon, 0.9, 1280, 720)});
    }
    places.push_back({"altitude unknown", cameraAt({kMoon + 100, 0, 0}, kNaN, pitch)});
    places.push_back({"altitude infinite", cameraAt({kMoon + 100, 0, 0}, kInfinity, pitch)});
  }
  return places;
}

std::vector<Place> nowhere() {
  std::vector<Place> places;
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (const glm::dvec3& position : {glm::dvec3(bad), glm::dvec3(bad, 0, 0), glm::dvec3(0, kMoon, bad)})
      places.push_back({"position", cameraAt(position, bad, 0)});
    Camera wideOpen = cameraAt({kMoon + 100, 0, 0}, 100, -0.5);
    wideOpen.verticalFieldOfView = bad;
    places.push_back({"field of view", wideOpen});
  }
  return places;
}

void expectFiniteAndDisjoint(const TileSelection& selection, const SelectionSettings& settings) {
  EXPECT_LE(selection.wanted.size(), static_cast<std::size_t>(2 * settings.maxTiles));
  for (const WantedTile& tile : selection.wanted) EXPECT_FALSE(std::isnan(tile.screenErrorPixels)) << tile.path.text();
  const std::unordered_set<FacePath> drawn(selection.draw.begin(), selection.draw.end());
  EXPECT_EQ(drawn.size(), selection.draw.size());
  for (const FacePath& path : selection.draw)
    for (int level = 0; level < path.level(); ++level) EXPECT_FALSE(drawn.contains(path.ancestor(level)));
}

TEST(CameraInHardPlaces, SelectsFinitelyManyDisjointTilesWithFiniteErrors) {
  const SelectionBody body = moon();
  const SelectionSettings settings;
  const ResidentTile known{kHeights};
  const ResidentLookup everything = [&](const FacePath&) { return &known; };
  std::size_t most = 0;
  for (const Place& place : hardPlaces()) {
    SCOPED_TRACE(testing::Message() << place.name << " at " << place.camera.positionBody.x << ' '
                                    << place.camera.positionBody.y << ' ' << place.camera.positionBody.z);
    const TileSelection blind = selectTiles(place.camera, body, {}, settings);
    expectFiniteAndDisjoint(blind, settings);
    EXPECT_TRUE(blind.draw.empty());
    const TileSelection selection = selectTiles(place.camera, body, everything, settings);
    expectFiniteAndDisjoint(selection, settings);
    EXPECT_TRUE(selection.complete);
    most = std::max(most, selection.wanted.size());
  }
  std::cout << "at most " << most << " tiles\n";
  EXPECT_GT(most, 100u) << "somewhere there is something to see";
}

TEST(CameraInHardPlaces, SeesGroundFromTheCentreWhicheverWayItLooks) {
  const ResidentTile known{kHeights};
  for (const double pitch : {-kPi / 2, 0.0, kPi / 2}) {
    const TileSelection selection =
        selectTiles(cameraAt({0, 0, 0}, -kMoon, pitch), moon(), [&](const FacePath&) { return &known; }, {});
    EXPECT_FALSE(selection.draw.empty());
  }
}

TEST(CameraInHardPlaces, SelectsNothingFromNowhere) {
  const ResidentTile known{kHeights};
  for (const Place& place : nowhere()) {
    const TileSelection selection = selectTiles(place.camera, moon(), [&](const FacePath&) { return &known; }, {});
    EXPECT_TRUE(selection.wanted.empty() && selection.draw.empty()) << place.name;
    EXPECT_FALSE(selection.complete) << place.name;
  }
}

/// The controls, each as it is usually written.
double unguardedForeshortening(const OrientedBox& box, const glm::dvec3& from) {
  const glm::dvec3 d = glm::abs(from - box.center), h(kMoon);
  const double distance = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
  return (h.y * h.z * d.x + h.z * h.x * d.y + h.x * h.y * d.z) / (h.x * h.y * distance);
}
int levelsRefined(double distanceMeters) {
  int level = 0;
  while (level < 1000 && !(std::ldexp(kMoon, -level) / distanceMeters <= 1e-3)) ++level;
  return level;
}

TEST(CameraInHardPlaces, WouldBeLostByTheUsualFormulas) {
  const FacePath face = FacePath::wholeFace(Scheme::Cube, 0);
  const OrientedBox box = tileBounds(face, kMoon, kHeights, kMoon).box;
  for (const double far : {1e300, std::numeric_limits<double>::max()}) {
    const glm::dvec3 from(far, far, 0);
    EXPECT_TRUE(std::isnan(unguardedForeshortening(box, from)));
    const double guarded = foreshortening(box, from);
    EXPECT_TRUE(guarded >= kLeastForeshortening && guarded <= 1.0);
    EXPECT_EQ(screenSpaceErrorPixels(1e4, box, cameraAt(from, far, 0)), 0.0);
  }
  EXPECT_EQ(levelsRefined(kMoon), 10);
  EXPECT_EQ(levelsRefined(kNaN), 1000) << "refined for ever";
  // At the centre there is no horizon.
  EXPECT_FALSE(Horizon(glm::dvec3(0.0), kMoon, -kMoon, kMoon - 9000).active());
}

}  // namespace
}  // namespace terrane

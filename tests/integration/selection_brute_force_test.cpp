// Tile selection against brute force: what random cameras really see of the lunar terrain, vertex by vertex, with the
// lowest terrain as the only occluder. Where selection culls a tile, what would be drawn there must have no visible
// vertex; a tile that it asks for should be in view. TERRANE_SELECTION_CAMERAS sets the number of cameras, TERRANE_SEED
// the seed.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <mutex>
#include <numbers>
#include <random>
#include <thread>
#include <unordered_map>
#include <unordered_set>

#include "common/tiling/lattice.h"
#include "common/view/frustum.h"
#include "common/view/horizon.h"
#include "common/view/level_of_detail.h"
#include "common/view/tile_selection.h"
#include "proto/resident_tile.h"
#include "server/build/tile_builder.h"
#include "tests/support/moon_body.h"
#include "tests/support/sanitizers.h"

namespace terrane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr long kCamerasForShare = 40;
constexpr int kDefaultCameras = test::kSanitized ? 4 : 150;
long environmentNumber(const char* name, long otherwise) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtol(text, nullptr, 10) : otherwise;
}

constexpr int kCells = 64;

/// What a tile's surface is made of, and what selection is told of it.
struct Ground {
  std::vector<glm::dvec3> points;  ///< the grid's vertices; skirts are no terrain
  ResidentTile resident;
};

class Terrain {
 public:
  Terrain()
      : builder_(testMoon(), {.cellsPerEdge = kCells, .draco = {}}, bestSimdPath()),
        field_(makeHeightField(testMoon(), bestSimdPath())) {}

  const SelectionBody& body() const { return builder_.info().selection; }

  double groundMeters(const glm::dvec3& direction) const {
    SurfaceSamples samples;
    field_->evaluate({&direction.x, &direction.y, &direction.z, 1, 1}, 0.0, samples);
    return samples.heightMeters[0];
  }

  Ground build(const FacePath& path) const {
    const Result<Tile> tile = builder_.buildMesh(path);
    Ground ground;
    if (tile.has_error()) {
      ADD_FAILURE() << tile.error().text();
      return ground;
    }
    ground.resident = residentTile(*tile, builder_.body().radiusMeters);
    for (std::size_t vertex = 0; vertex < (kCells + 1) * (kCells + 1); ++vertex) {
      const std::uint16_t* offset = tile->mesh.offsets.data() + 3 * vertex;
      ground.points.push_back(latticePosition(tile->metadata.origin + LatticePoint(offset[0], offset[1], offset[2]),
                                              tile->metadata.stepExponent));
    }
    return ground;
  }

 private:
  TileBuilder builder_;
  std::unique_ptr<const HeightField> field_;
};

const Terrain& terrain() {
  static const Terrain made;
  return made;
}

/// The tiles that one camera has to do with, built when they are first asked for. Coarse ones are kept for all cameras.
class GroundCache {
 public:
  const Ground& operator[](const FacePath& path) {
    auto& level = path.level() <= 4 ? shared_ : own_;
    const auto found = level.find(path);
    return found != level.end() ? found->second : level.emplace(path, terrain().build(path)).first->second;
  }
  void nextCamera() { own_.clear(); }

 private:
  std::unordered_map<FacePath, Ground> shared_, own_;
};

Camera randomCamera(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  ViewPose pose;
  pose.longitude = (2 * unit(random) - 1) * kPi;
  pose.latitude = std::asin(2 * unit(random) - 1);
  pose.heading = (2 * unit(random) - 1) * kPi;
  // Down, level and up, a little off in two cases of three.
  const double pitches[] = {-kPi / 2, 0, kPi / 6};
  pose.pitch = pitches[random() % 3];
  if (random() % 3 != 0) pose.pitch = std::clamp(pose.pitch + 0.4 * (unit(random) - 0.5), -kPi / 2, kPi / 2);
  const glm::dvec3 direction(std::cos(pose.latitude) * std::cos(pose.longitude),
                             std::cos(pose.latitude) * std::sin(pose.longitude), std::sin(pose.latitude));
  pose.altitudeMeters = terrain().groundMeters(direction) + 0.2 * std::pow(1e7 / 0.2, unit(random));
  return cameraFromPose(pose, terrain().body().radiusMeters, 0.9, 1280, 720);
}

/// Is a part of the triangle in the picture and above the horizon? Clipped by the planes of the view; what hides behind
/// the occluder is convex, so a polygon is hidden when its corners are.
class Sight {
 public:
  explicit Sight(const Camera& camera)
      : camera_(camera),
        frustum_(camera),
        horizon_(camera.positionBody, terrain().body().radiusMeters, camera.altitudeMeters,
                 terrain().body().occluderRadiusMeters) {
    const double top = std::tan(camera.verticalFieldOfView / 2), side = top * camera.widthPixels / camera.heightPixels;
    const glm::dvec3 forward = -camera.backward;
    normals_ = {camera.right + side * forward, side * forward - camera.right, camera.up + top * forward,
                top * forward - camera.up, forward};
  }

  bool sees(const glm::dvec3& point) const { return frustum_.contains(point) && !horizon_.hides(point); }

  bool seesVertex(const Ground& ground) const {
    return std::any_of(ground.points.begin(), ground.points.end(), [&](const glm::dvec3& p) { return sees(p); });
  }

  bool seesTriangle(const Ground& ground) const {
    constexpr std::size_t kSide = kCells + 1;
    for (std::size_t j = 0; j + 1 < kSide; ++j) {
      for (std::size_t i = 0; i + 1 < kSide; ++i) {
        const std::size_t at = j * kSide + i;
        if (seesPolygon({ground.points[at], ground.points[at + 1], ground.points[at + kSide + 1]}) ||
            seesPolygon({ground.points[at], ground.points[at + kSide + 1], ground.points[at + kSide]}))
          return true;
      }
    }
    return false;
  }

 private:
  bool seesPolygon(std::vector<glm::dvec3> polygon) const {
    for (std::size_t plane = 0; plane < normals_.size(); ++plane) {
      const double offset = plane == 4 ? camera_.nearMeters : 0.0;
      const auto above = [&](const glm::dvec3& p) {
        return glm::dot(normals_[plane], p - camera_.positionBody) - offset;
      };
      std::vector<glm::dvec3> cut;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = above(a), db = above(b);
        if (da >= 0) cut.push_back(a);
        if ((da >= 0) != (db >= 0)) cut.push_back(a + (b - a) * (da / (da - db)));
      }
      if (cut.empty()) return false;
      polygon.swap(cut);
    }
    return std::any_of(polygon.begin(), polygon.end(), [&](const glm::dvec3& p) { return !horizon_.hides(p); });
  }

  const Camera& camera_;
  Frustum frustum_;
  Horizon horizon_;
  std::array<glm::dvec3, 5> normals_;
};

struct Count {
  long cameras = 0, asked = 0, leaves = 0, culled = 0;
  long rounds = 0;                ///< of asking, until nothing new is
  long loaded = 0;                ///< asked for at any time on the way
  long omitted = 0;               ///< culled, with a visible vertex
  long withoutVertex = 0;         ///< leaves asked for without a visible vertex
  long withoutTriangle = 0;       ///< of these: without any part of a triangle in view either
  long askedWithoutTriangle = 0;  ///< the same of all tiles asked for, ancestors included
  Count& operator+=(const Count& o) {
    cameras += o.cameras, loaded += o.loaded, rounds += o.rounds, asked += o.asked, leaves += o.leaves,
        culled += o.culled, omitted += o.omitted;
    withoutVertex += o.withoutVertex, withoutTriangle += o.withoutTriangle,
        askedWithoutTriangle += o.askedWithoutTriangle;
    return *this;
  }
};

/// Every tile that selection looked at and left out: children of refined tiles, and roots, that are not wanted.
std::vector<FacePath> culledTiles(const std::vector<WantedTile>& wanted) {
  std::unordered_set<FacePath> set;
  for (const WantedTile& tile : wanted) set.insert(tile.path);
  std::vector<FacePath> culled;
  for (int face = 0; face < 6; ++face)
    if (const FacePath root = FacePath::wholeFace(Scheme::Cube, face); !set.contains(root)) culled.push_back(root);
  for (const WantedTile& tile : wanted) {
    for (int digit = 0; digit < 4 && !tile.leaf; ++digit)
      if (!set.contains(tile.path.child(digit))) culled.push_back(tile.path.child(digit));
  }
  return culled;
}

/// Is a vertex in view of what would be drawn over a tile's footprint: its own mesh, or where its error is too large,
/// its children's? (A coarse mesh may stand out of the ground that is shown in its place.)
bool seesWhatIsDrawn(const FacePath& path, const Camera& camera, const Sight& sight, GroundCache& ground) {
  if (!sight.seesVertex(ground[path])) return false;
  const SelectionBody& body = terrain().body();
  const OrientedBox box =
      tileBounds(path, body.radiusMeters, *ground[path].resident.ownHeights, body.occluderRadiusMeters).box;
  const double error = body.geometricErrorMeters[static_cast<std::size_t>(path.level())];
  if (path.level() == body.maxLevel || screenSpaceErrorPixels(error, box, camera) <= SelectionSettings{}.errorPixels)
    return true;
  for (int digit = 0; digit < 4; ++digit)
    if (seesWhatIsDrawn(path.child(digit), camera, sight, ground)) return true;
  return false;
}

Count judge(const Camera& camera, GroundCache& ground) {
  // Resident is what was asked for, as in a viewer: of all other tiles only their ancestors' word is known.
  std::unordered_set<FacePath> residents;
  const ResidentLookup lookup = [&](const FacePath& path) {
    return residents.contains(path) ? &ground[path].resident : nullptr;
  };
  TileSelection selection;
  Count count;
  for (bool news = true; news; ++count.rounds) {
    selection = selectTiles(camera, terrain().body(), lookup, {});
    news = false;
    for (const WantedTile& tile : selection.wanted) news = residents.insert(tile.path).second || news;
  }
  EXPECT_TRUE(selection.complete);

  const Sight sight(camera);
  count.cameras = 1;
  count.loaded = static_cast<long>(residents.size());
  for (const WantedTile& tile : selection.wanted) {
    ++count.asked;
    count.leaves += tile.leaf;
    if (sight.seesVertex(ground[tile.path])) continue;
    count.withoutVertex += tile.leaf;
    if (sight.seesTriangle(ground[tile.path])) continue;
    count.withoutTriangle += tile.leaf;
    ++count.askedWithoutTriangle;
  }
  for (const FacePath& path : culledTiles(selection.wanted)) {
    ++count.culled;
    if (!seesWhatIsDrawn(path, camera, sight, ground)) continue;
    ++count.omitted;
    const ViewPose pose = poseFromCamera(camera);
    ADD_FAILURE() << path.text() << " omitted at " << pose.longitude << ' ' << pose.latitude << ' '
                  << pose.altitudeMeters;
  }
  return count;
}

TEST(SelectionBruteForce, OmitsNoVisibleVertexAndAsksForFewTilesOutOfView) {
  const long cameras = environmentNumber("TERRANE_SELECTION_CAMERAS", kDefaultCameras);
  const long seed = environmentNumber("TERRANE_SEED", 10'000);
  std::mutex mutex;
  Count total;
  std::atomic<long> next{0};
  std::vector<std::jthread> workers;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) {
    workers.emplace_back([&] {
      GroundCache ground;
      Count mine;
      for (long camera = next++; camera < cameras; camera = next++) {
        std::mt19937_64 random(static_cast<std::uint64_t>(seed + camera));
        mine += judge(randomCamera(random), ground);
        ground.nextCamera();
      }
      const std::lock_guard lock(mutex);
      total += mine;
    });
  }
  workers.clear();

  const auto percent = [&](long part, long whole) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(std::max(1L, whole));
  };
  std::printf("seed %ld, %ld cameras, %ld tiles asked for (%ld leaves; %ld on the way, in %.1f rounds), %ld culled\n",
              seed, total.cameras, total.asked, total.leaves, total.loaded,
              static_cast<double>(total.rounds) / static_cast<double>(std::max(1L, total.cameras)), total.culled);
  std::printf("omitted with a visible vertex: %ld\n", total.omitted);
  std::printf(
      "leaves asked for without a visible vertex: %ld (%.2f %%); without a visible part of a triangle: %ld (%.2f %%)\n",
      total.withoutVertex, percent(total.withoutVertex, total.leaves), total.withoutTriangle,
      percent(total.withoutTriangle, total.leaves));
  std::printf("all tiles asked for without a visible part of a triangle: %ld (%.2f %%)\n", total.askedWithoutTriangle,
              percent(total.askedWithoutTriangle, total.asked));
  EXPECT_EQ(total.omitted, 0);
  // The share is a figure of many views: a handful, as sanitizers run, holds too few tiles to say anything about it.
  if (cameras < kCamerasForShare) return;
  EXPECT_LE(percent(total.withoutTriangle, total.leaves), 5.0);
  EXPECT_LE(percent(total.askedWithoutTriangle, total.asked), 5.0);
  EXPECT_GT(total.leaves, total.cameras);
}

}  // namespace
}  // namespace terrane

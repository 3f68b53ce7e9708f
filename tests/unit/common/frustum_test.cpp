#include "common/view/frustum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <vector>

#include "common/tiling/cube_sphere.h"

namespace terrane {
namespace {

constexpr double kMoon = 1'737'400.0;
constexpr double kPi = std::numbers::pi;
constexpr unsigned kSeed = 1975;

using Hull = std::array<glm::dvec3, 8>;

struct Views {
  std::mt19937_64 random{kSeed};
  std::uniform_real_distribution<double> unit{0, 1};

  double between(double low, double high) { return low + (high - low) * unit(random); }
  Camera camera() {
    const ViewPose pose{between(-kPi, kPi), std::asin(between(-1, 1)), std::pow(10.0, between(-0.7, 7)),
                        between(-kPi, kPi), between(-kPi / 2, kPi / 2)};
    return cameraFromPose(pose, kMoon, between(0.3, 1.8), 1280, 720);
  }
  /// A tile somewhere near the camera, of about the size that it would look at.
  Hull tileNear(const Camera& camera) {
    const int level = static_cast<int>(between(0, 24));
    const double distance =
        std::pow(10.0, between(-0.5, 0.7)) * std::max(camera.altitudeMeters, kMoon / std::ldexp(1.0, level));
    const glm::dvec3 place =
        camera.positionBody + distance * glm::dvec3(between(-1, 1), between(-1, 1), between(-1, 1));
    const double relief = between(0, 0.3) * kMoon / std::ldexp(1.0, level + 1);
    return tileBounds(tileAt(place, level), kMoon, {-relief, relief}, kMoon * 0.98).hull;
  }

 private:
  static FacePath tileAt(const glm::dvec3& place, int level) {
    const FaceCoordinates at = cubeFaceCoordinates(place);
    const auto index = [&](double s) {
      const double cells = std::ldexp(1.0, level);
      return static_cast<std::uint32_t>(std::clamp(std::floor((s + 1) / 2 * cells), 0.0, cells - 1));
    };
    return FacePath::cubeTile(at.face, level, index(at.s), index(at.t));
  }
};

/// The oracle: the hull's surface, cut by the view's planes one after another (Sutherland and Hodgman 1974). The
/// frustum is unbounded and the hull is not, so they meet exactly if some piece of that surface is left.
bool surfaceReachesInto(const Camera& camera, const Hull& hull) {
  constexpr int kTriangles[][3] = {{0, 1, 4}, {1, 5, 4}, {1, 3, 5}, {3, 7, 5}, {3, 2, 7}, {2, 6, 7},
                                   {2, 0, 6}, {0, 4, 6}, {4, 5, 7}, {4, 7, 6}, {4, 5, 6}, {5, 7, 6},
                                   {0, 1, 3}, {0, 3, 2}, {0, 1, 2}, {1, 3, 2}};
  const double top = std::tan(camera.verticalFieldOfView / 2), side = top * camera.widthPixels / camera.heightPixels;
  const glm::dvec3 forward = -camera.backward;
  const glm::dvec3 normals[] = {camera.right + side * forward, side * forward - camera.right, camera.up + top * forward,
                                top * forward - camera.up, forward};
  for (const auto& triangle : kTriangles) {
    std::vector<glm::dvec3> polygon;
    for (const int corner : triangle) polygon.push_back(hull[static_cast<std::size_t>(corner)] - camera.positionBody);
    for (const glm::dvec3& normal : normals) {
      const double offset = &normal == &normals[4] ? camera.nearMeters : 0.0;
      std::vector<glm::dvec3> cut;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = glm::dot(normal, a) - offset, db = glm::dot(normal, b) - offset;
        if (da >= 0) cut.push_back(a);
        if ((da >= 0) != (db >= 0)) cut.push_back(a + (b - a) * (da / (da - db)));
      }
      polygon.swap(cut);
    }
    if (!polygon.empty()) return true;
  }
  return false;
}

TEST(Frustum, ContainsWhatThePictureShows) {
  Views views;
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = views.camera();
    const Frustum frustum(camera);
    const glm::dvec3 eye(views.between(-3, 3), views.between(-3, 3), -std::pow(10.0, views.between(-3, 6)));
    const glm::dvec3 seen(eye.x * -eye.z, eye.y * -eye.z, eye.z);
    const glm::dvec4 clip = reversedInfiniteProjection(camera) * glm::dvec4(seen, 1);
    const double margin = std::min({clip.w - std::abs(clip.x), clip.w - std::abs(clip.y), clip.w - camera.nearMeters});
    if (std::abs(margin) < 1e-6 * clip.w) continue;
    const glm::dvec3 point =
        camera.positionBody + camera.right * seen.x + camera.up * seen.y + camera.backward * seen.z;
    EXPECT_EQ(frustum.contains(point), margin > 0) << i;
  }
}

TEST(Frustum, ContainsASphereWhoseEveryPointItContains) {
  Views views;
  int contained = 0;
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = views.camera();
    const Frustum frustum(camera);
    const double distance = std::pow(10.0, views.between(-3, 6));
    const glm::dvec3 center = camera.positionBody + camera.right * (distance * views.between(-0.5, 0.5)) +
                              camera.up * (distance * views.between(-0.5, 0.5)) - camera.backward * distance;
    const double radiusMeters = distance * views.between(0, 0.6);
    bool allInside = true;
    for (int j = 0; j < 500; ++j) {
      const glm::dvec3 way(views.between(-1, 1), views.between(-1, 1), views.between(-1, 1));
      allInside = allInside && frustum.contains(center + glm::normalize(way) * radiusMeters);
    }
    const bool answer = frustum.contains(Sphere{center, radiusMeters});
    EXPECT_TRUE(allInside || !answer) << i;
    contained += answer ? 1 : 0;
  }
  EXPECT_GT(contained, 100);
}

TEST(Frustum, NeverMissesATileAndRarelyTakesOneTooMany) {
  Views views;
  RecordProperty("seed", kSeed);
  int inside = 0, tooMany = 0;
  constexpr int kViews = 20'000;
  for (int i = 0; i < kViews; ++i) {
    const Camera camera = views.camera();
    const Hull hull = views.tileNear(camera);
    const bool truth = surfaceReachesInto(camera, hull), answer = Frustum(camera).mayContain(hull);
    EXPECT_TRUE(answer || !truth) << "missed at " << i;
    inside += truth;
    tooMany += answer && !truth;
  }
  std::printf("%d of %d tiles in view, %d taken without being so\n", inside, kViews, tooMany);
  EXPECT_GT(inside, kViews / 20);
  EXPECT_LE(tooMany, kViews / 5000);
}

TEST(Frustum, TakesAHullThatHoldsTheCamera) {
  Views views;
  for (int i = 0; i < 500; ++i) {
    const Camera camera = views.camera();
    Hull hull;
    for (std::size_t k = 0; k < 8; ++k)
      hull[k] = camera.positionBody + glm::dvec3((k & 1) ? 5 : -4, (k & 2) ? 3 : -6, (k & 4) ? 8 : -2);
    EXPECT_TRUE(Frustum(camera).mayContain(hull));
  }
}

TEST(Frustum, TakesAHullThatCannotBeJudged) {
  Hull hull{};
  hull.fill(glm::dvec3(std::nan("")));
  EXPECT_TRUE(Frustum(Views().camera()).mayContain(hull));
}

TEST(Frustum, LeavesOutWhatLiesBehindOrBefore) {
  const Camera camera = cameraFromPose({0, 0, 1000, 0, 0}, kMoon, 0.9, 1280, 720);
  const auto boxAt = [&](const glm::dvec3& center, double size) {
    Hull hull;
    for (std::size_t k = 0; k < 8; ++k)
      hull[k] = center + size * glm::dvec3((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1);
    return hull;
  };
  const Frustum frustum(camera);
  const glm::dvec3 forward = -camera.backward;
  EXPECT_TRUE(frustum.mayContain(boxAt(camera.positionBody + forward * 10.0, 1)));
  EXPECT_FALSE(frustum.mayContain(boxAt(camera.positionBody - forward * 10.0, 1)));
  EXPECT_FALSE(
      frustum.mayContain(boxAt(camera.positionBody + forward * (camera.nearMeters / 2), camera.nearMeters / 10)));
  EXPECT_TRUE(frustum.mayContain(boxAt(camera.positionBody + forward * 1e12, 1)));
}

}  // namespace
}  // namespace terrane

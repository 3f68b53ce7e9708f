// What a tile's horizon point hides is hidden, nearly all that is hidden is found so, and the sphere that does the
// hiding lies below all ground.

#include "common/tiling/tile_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "tests/unit/common/surface_samples.h"

namespace terrane {
namespace {

using test::Case;
using test::Random;
using test::randomCase;
using test::samplePoint;
using test::Vec;

/// Hidden if the segment from the camera to the point enters the open ball of the given radius about the origin.
bool segmentIsBlocked(const Vec& camera, const Vec& p, long double radius) {
  const Vec d = p - camera;
  const long double along = std::clamp(-dot(camera, d) / dot(d, d), 0.0L, 1.0L);
  return length(camera + d * along) < radius;
}

/// The two of the sources: behind the plane of the horizon, and within its cone (Ring 2013).
bool belowHorizon(const Vec& camera, const Vec& p, long double radius) {
  const Vec c = camera * (1 / radius);
  const Vec t = p * (1 / radius) - c;
  const long double horizonSquared = dot(c, c) - 1;
  const long double s = -dot(t, c);
  return horizonSquared > 0 && s > horizonSquared && s * s > horizonSquared * dot(t, t);
}

/// A camera at an altitude of 1e-4 tile widths to 100 radii, often right where the horizon point comes into view.
Vec randomCamera(Random& random, const Vec& horizonPoint, double occluder, double tileWidth) {
  const double low = 1e-4 * tileWidth;
  const long double altitude = low * std::pow(100.0 * occluder / low, random.unit());
  const long double distance = occluder + altitude;
  const long double pointLength = length(horizonPoint);
  const long double reach = std::acos(std::min(1.0L, occluder / pointLength)) + std::acos(occluder / distance);
  const long double angle =
      random.below(2) ? reach * (1 + 1e-3L * (random.unit() - 0.3L)) : std::acos(random.between(-1, 1));
  const Vec axis = horizonPoint * (1 / pointLength);
  Vec side = cross(axis, Vec{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
  side = side * (1 / length(side));
  return (axis * std::cos(angle) + side * std::sin(angle)) * distance;
}

TEST(TileBounds, ATileIsHiddenWhereverItsHorizonPointIs) {
  Random random(203);
  int hidden = 0, near = 0, points = 0;
  for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
    for (int tile = 0; tile < 16; ++tile) {
      const Case c = randomCase(random, level);
      const double occluder = c.radius + c.heights.minMeters - random.unit() * 0.01 * c.radius;
      const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, occluder);
      if (!std::isfinite(bounds.horizonPoint.x)) continue;
      ++points;
      const Vec point(bounds.horizonPoint);
      for (int i = 0; i < 60; ++i) {
        const Vec camera = randomCamera(random, point, occluder, nominalTileWidthMeters(c.radius, level));
        if (!belowHorizon(camera, point, occluder)) {
          ++near;
          continue;
        }
        ++hidden;
        for (int k = 0; k < 24; ++k) {
          ASSERT_TRUE(segmentIsBlocked(camera, Vec(samplePoint(random, c)), occluder))
              << c.path.text() << " radius " << c.radius << " heights " << c.heights.minMeters << " "
              << c.heights.maxMeters;
        }
      }
    }
  }
  std::cout << points << " points, hidden from " << hidden << " cameras, seen from " << near << '\n';
  EXPECT_GT(hidden, 1000);
  EXPECT_GT(near, 1000);
}

TEST(TileBounds, TheHorizonPointMissesFewHiddenTiles) {
  // The Moon, cameras as a flight has them, tiles of the size that such a camera draws and a little beyond its horizon.
  Random random(204);
  const double radius = 1737400.0;
  const double occluder = lowestSurfaceRadiusMeters(radius, -9000.0, 64);
  int hidden = 0, missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const int level = 2 + static_cast<int>(random.below(16));
    Case c = randomCase(random, level);
    c.radius = radius;
    c.heights.minMeters = random.between(-9000.0, 5000.0);
    c.heights.maxMeters = c.heights.minMeters + 0.1 * nominalTileWidthMeters(radius, level);
    const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, occluder);
    ASSERT_TRUE(std::isfinite(bounds.horizonPoint.x));
    const Vec axis(bounds.sphere.center);
    Vec side = cross(axis, Vec{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
    side = side * (1 / length(side));
    const long double altitude = std::pow(10.0, random.between(1.0, 7.0));
    const long double angle = 3.1415926L * random.unit();
    const Vec camera = (axis * (1 / length(axis)) * std::cos(angle) + side * std::sin(angle)) * (radius + altitude);
    bool allHidden = true;
    for (int k = 0; k < 40 && allHidden; ++k) {
      allHidden = segmentIsBlocked(camera, Vec(samplePoint(random, c)), occluder);
    }
    if (!allHidden) continue;
    ++hidden;
    if (!belowHorizon(camera, Vec(bounds.horizonPoint), occluder)) ++missed;
  }
  std::cout << "of " << hidden << " hidden tiles " << missed << " are not detected: " << 100.0 * missed / hidden
            << " %\n";
  EXPECT_GT(hidden, 5000);
  EXPECT_LE(missed, hidden / 50);
}

TEST(TileBounds, ATileTooLargeForAHorizonPointSaysSo) {
  const double radius = 1000.0;
  const FacePath face = FacePath::wholeFace(Scheme::Cube, 2);
  EXPECT_TRUE(std::isfinite(tileBounds(face, radius, {0, 0}, 999.0).horizonPoint.x));
  EXPECT_TRUE(std::isnan(tileBounds(face, radius, {0, 300}, 1000.0).horizonPoint.x));
  EXPECT_TRUE(std::isnan(tileBounds(face, radius, {0, 0}, 0.0).horizonPoint.x));
  EXPECT_TRUE(std::isnan(tileBounds(face, radius, {0, 0}, -5.0).horizonPoint.x));
}

/// Distance from the origin to a triangle.
long double distanceToTriangle(const Vec& a, const Vec& b, const Vec& c) {
  const auto segment = [](const Vec& p, const Vec& q) {
    const Vec d = q - p;
    return length(p + d * std::clamp(-dot(p, d) / dot(d, d), 0.0L, 1.0L));
  };
  const Vec normal = cross(b - a, c - a);
  const Vec foot = normal * (dot(normal, a) / dot(normal, normal));
  const bool inside = dot(cross(b - a, foot - a), normal) >= 0 && dot(cross(c - b, foot - b), normal) >= 0 &&
                      dot(cross(a - c, foot - c), normal) >= 0;
  if (inside) return length(foot);
  return std::min(segment(a, b), std::min(segment(b, c), segment(c, a)));
}

TEST(TileBounds, NoTriangleOfTheCoarsestMeshDipsBelowTheLowestSurface) {
  Random random(206);
  const double radius = 1737400.0;
  const int exponent = stepExponent(radius, 0);
  for (const int cells : {1, 2, 3, 4, 8, 16, 32, 64}) {
    for (const double lowest : {0.0, -9000.0}) {
      const double bound = lowestSurfaceRadiusMeters(radius, lowest, cells);
      long double least = 1e300L;
      const auto vertex = [&](int i, int j) {
        // Lowest at random vertices, so that some triangles are low throughout; on the lattice as tiles have it.
        const double height = random.below(4) ? lowest : random.between(lowest, lowest + 20000.0);
        const glm::dvec3 d = cubeDirection(0, 2.0 * i / cells - 1.0, 2.0 * j / cells - 1.0);
        return Vec(latticePosition(roundToLattice(d * (radius + height), exponent), exponent));
      };
      for (int round = 0; round < (cells > 16 ? 1 : 8); ++round) {
        std::vector<Vec> grid;
        for (int j = 0; j <= cells; ++j) {
          for (int i = 0; i <= cells; ++i) grid.push_back(vertex(i, j));
        }
        const auto at = [&](int i, int j) { return grid[static_cast<std::size_t>(j * (cells + 1) + i)]; };
        for (int j = 0; j < cells; ++j) {
          for (int i = 0; i < cells; ++i) {
            const Vec a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
            least = std::min({least, distanceToTriangle(a, b, d), distanceToTriangle(a, d, c),
                              distanceToTriangle(a, b, c), distanceToTriangle(b, d, c)});
          }
        }
      }
      ASSERT_GE(least, static_cast<long double>(bound)) << cells;
      if (lowest == 0.0) {
        std::cout << cells << " cells: lowest triangle " << radius - static_cast<double>(least) << " m below, bound "
                  << radius - bound << " m\n";
      }
      if (cells >= 32) {
        EXPECT_LE(static_cast<double>(least) - bound, 1e-4 * radius) << "a bound that hides nothing is no use";
      }
    }
  }
}

}  // namespace
}  // namespace terrane

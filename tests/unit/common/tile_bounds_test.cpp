#include "common/tiling/tile_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"

namespace terrane {
namespace {

// Checks are made in long double, so that what they find is the volumes' error and not their own.
struct Vec {
  long double x, y, z;
  Vec(long double a, long double b, long double c) : x(a), y(b), z(c) {}
  explicit Vec(const glm::dvec3& p) : x(p.x), y(p.y), z(p.z) {}
};
Vec operator-(const Vec& a, const Vec& b) { return Vec(a.x - b.x, a.y - b.y, a.z - b.z); }
Vec operator+(const Vec& a, const Vec& b) { return Vec(a.x + b.x, a.y + b.y, a.z + b.z); }
Vec operator*(const Vec& a, long double k) { return Vec(a.x * k, a.y * k, a.z * k); }
long double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
long double length(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec cross(const Vec& a, const Vec& b) {
  return Vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

struct Random {
  explicit Random(std::uint64_t seed) : engine(seed) { std::cout << "seed " << seed << '\n'; }
  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(engine); }
  double between(double a, double b) { return a + (b - a) * unit(); }
  std::uint64_t below(std::uint64_t n) { return engine() % n; }
  std::mt19937_64 engine;
};

struct Case {
  FacePath path;
  double radius;
  HeightRange heights;
};

/// Tiles anywhere, at a face's centre, and at cube corners, of bodies from an asteroid to the Sun.
Case randomCase(Random& random, int level) {
  const double radius = kMinRadiusMeters * std::pow(kMaxRadiusMeters / kMinRadiusMeters, random.unit());
  const std::uint64_t cells = std::uint64_t{1} << level;
  const auto index = [&] {
    const std::uint64_t kind = random.below(6);
    return static_cast<std::uint32_t>(kind == 0   ? 0
                                      : kind == 1 ? cells - 1
                                      : kind == 2 ? cells / 2
                                                  : random.below(cells));
  };
  HeightRange heights;
  switch (random.below(5)) {
    case 0:
      break;
    case 1:
      heights = {-0.006 * radius, 0.006 * radius};
      break;
    case 2:
      heights = {-0.2 * radius, 0.3 * radius};
      break;
    case 3:
      heights = {0.05 * radius, 0.05 * radius + 1.0};
      break;
    default: {
      // As thin as the tile is wide, anywhere.
      const double width = nominalTileWidthMeters(radius, level);
      heights.minMeters = random.between(-0.1, 0.1) * radius;
      heights.maxMeters = heights.minMeters + 0.1 * width * random.unit();
    }
  }
  const int face = static_cast<int>(random.below(6));
  const std::uint32_t column = index();
  return Case{FacePath::cubeTile(face, level, column, index()), radius, heights};
}

/// A surface point of the tile: grid corners and edges often, the inside too, at the lowest, the highest or any height,
/// and half of the time rounded to the level's lattice, as a vertex is.
glm::dvec3 samplePoint(Random& random, const Case& c) {
  const int grid = 20;
  const auto offset = [&]() -> std::uint64_t {
    const std::uint64_t kind = random.below(4);
    return kind == 0 ? 0 : kind == 1 ? (1u << grid) : random.below((1u << grid) + 1);
  };
  const std::uint64_t column = (std::uint64_t{c.path.column()} << grid) + offset();
  const std::uint64_t row = (std::uint64_t{c.path.row()} << grid) + offset();
  const std::uint64_t kind = random.below(3);
  const double height = kind == 0   ? c.heights.minMeters
                        : kind == 1 ? c.heights.maxMeters
                                    : random.between(c.heights.minMeters, c.heights.maxMeters);
  const glm::dvec3 p = cubeGridDirection(c.path.face(), c.path.level() + grid, column, row) * (c.radius + height);
  if (random.below(2)) return p;
  const int exponent = stepExponent(c.radius, c.path.level());
  return latticePosition(roundToLattice(p, exponent), exponent);
}

/// The supporting planes of the hull of eight points: all planes through three of them with no other in front.
struct Plane {
  Vec normal;  ///< unit, outward
  long double offset;
};
std::vector<Plane> supportingPlanes(const std::array<glm::dvec3, 8>& hull) {
  const Vec origin(hull[0]);
  std::vector<Vec> points;
  for (const glm::dvec3& p : hull) points.push_back(Vec(p) - origin);
  long double size = 0;
  for (const Vec& p : points) size = std::max(size, length(p));
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t j = i + 1; j < 8; ++j) {
      for (std::size_t k = j + 1; k < 8; ++k) {
        Vec normal = cross(points[j] - points[i], points[k] - points[i]);
        const long double norm = length(normal);
        if (norm < 1e-9L * size * size) continue;
        normal = normal * (1 / norm);
        long double low = 0, high = 0;
        for (const Vec& p : points) {
          low = std::min(low, dot(normal, p - points[i]));
          high = std::max(high, dot(normal, p - points[i]));
        }
        // Four corners of a face are in one plane only up to rounding.
        const long double flat = 1e-12L * size + 1e-15L * length(origin);
        if (high <= flat) planes.push_back({normal, dot(normal, points[i]) + high});
        if (low >= -flat) planes.push_back({normal * -1, -dot(normal, points[i]) - low});
      }
    }
  }
  return planes;
}

bool boxContains(const OrientedBox& box, const Vec& p) {
  for (const glm::dvec3& half : box.halfAxes) {
    const Vec h(half);
    if (std::fabs(dot(p - Vec(box.center), h)) > dot(h, h)) return false;
  }
  return true;
}

TEST(TileBounds, ContainEverySurfacePointVertexAndChord) {
  Random random(201);
  for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
    for (int tile = 0; tile < 24; ++tile) {
      const Case c = randomCase(random, level);
      SCOPED_TRACE(c.path.text() + " radius " + std::to_string(c.radius) + " heights " +
                   std::to_string(c.heights.minMeters) + " " + std::to_string(c.heights.maxMeters));
      const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, 0.9 * c.radius);
      const std::vector<Plane> planes = supportingPlanes(bounds.hull);
      ASSERT_GE(planes.size(), 6u);
      Vec previous(samplePoint(random, c));
      for (int i = 0; i < 200; ++i) {
        const Vec vertex(samplePoint(random, c));
        const long double at = random.unit();
        const Vec p = i % 4 == 3 ? vertex * at + previous * (1 - at) : vertex;
        previous = vertex;
        ASSERT_TRUE(boxContains(bounds.box, p));
        ASSERT_LE(length(p - Vec(bounds.sphere.center)), static_cast<long double>(bounds.sphere.radiusMeters));
        const Vec local = p - Vec(bounds.hull[0]);
        for (const Plane& plane : planes) ASSERT_LE(dot(plane.normal, local), plane.offset);
      }
    }
  }
}

TEST(TileBounds, ContainWhatEveryDescendantDraws) {
  Random random(207);
  for (int level = 0; level < FacePath::kMaxLevel; ++level) {
    for (int tile = 0; tile < 12; ++tile) {
      const Case c = randomCase(random, level);
      const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, 0.9 * c.radius);
      const std::vector<Plane> planes = supportingPlanes(bounds.hull);
      for (int i = 0; i < 100; ++i) {
        Case descendant = c;
        const int depth = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(FacePath::kMaxLevel - level)));
        for (int k = 0; k < depth; ++k) descendant.path = descendant.path.child(static_cast<int>(random.below(4)));
        const Vec p(samplePoint(random, descendant));
        ASSERT_TRUE(boxContains(bounds.box, p)) << c.path.text() << " " << descendant.path.text();
        ASSERT_LE(length(p - Vec(bounds.sphere.center)), static_cast<long double>(bounds.sphere.radiusMeters));
        for (const Plane& plane : planes) ASSERT_LE(dot(plane.normal, p - Vec(bounds.hull[0])), plane.offset);
      }
    }
  }
}

TEST(TileBounds, BoxAndSphereAreTight) {
  Random random(202);
  double loosestBox = 0, loosestSphere = 0;
  for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
    for (int tile = 0; tile < 12; ++tile) {
      const Case c = randomCase(random, level);
      const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, 0.9 * c.radius);
      std::vector<Vec> points;
      const int grid = 4;
      for (std::uint64_t j = 0; j <= (1u << grid); ++j) {
        for (std::uint64_t i = 0; i <= (1u << grid); ++i) {
          const glm::dvec3 d =
              cubeGridDirection(c.path.face(), level + grid, (std::uint64_t{c.path.column()} << grid) + i,
                                (std::uint64_t{c.path.row()} << grid) + j);
          for (const double height : {c.heights.minMeters, c.heights.maxMeters})
            points.push_back(Vec(d * (c.radius + height)));
        }
      }
      const double step = stepMeters(stepExponent(c.radius, level));
      for (const glm::dvec3& half : bounds.box.halfAxes) {
        const long double size = length(Vec(half));
        long double low = 1e300L, high = -1e300L;
        for (const Vec& p : points) {
          const long double along = dot(p - Vec(bounds.box.center), Vec(half)) / size;
          low = std::min(low, along);
          high = std::max(high, along);
        }
        // What is added on purpose is a few steps; the rest is the grid's own sampling.
        loosestBox = std::max(loosestBox, static_cast<double>((size - 6 * step) / (0.5L * (high - low) + 1e-30L)));
      }
      // No sphere can be smaller than half the largest distance between two points; 2/sqrt(3) is Jung's bound in a
      // plane.
      long double widest = 0;
      for (std::size_t i = 0; i < points.size(); i += 7) {
        for (const Vec& q : points) widest = std::max(widest, length(points[i] - q));
      }
      loosestSphere =
          std::max(loosestSphere, (bounds.sphere.radiusMeters - 6 * step) / (0.5 * static_cast<double>(widest)));
    }
  }
  std::cout << "loosest box side " << loosestBox << ", sphere " << loosestSphere << " times the least possible\n";
  EXPECT_LE(loosestBox, 1.01);
  EXPECT_LE(loosestSphere, 1.2);
}

TEST(TileBounds, EveryBuildComputesTheSameBits) {
  // Golden: bounds are written into tiles, so they are part of a tile's bytes.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&](const glm::dvec3& p) {
    for (const double value : {p.x, p.y, p.z}) hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u;
  };
  std::uint64_t state = 1;
  const auto next = [&] { return state = state * 6364136223846793005u + 1442695040888963407u; };
  for (int i = 0; i < 3000; ++i) {
    const int level = i % 31;
    const std::uint64_t cells = std::uint64_t{1} << level;
    const std::uint32_t column = static_cast<std::uint32_t>((next() >> 33) % cells);
    const FacePath path = FacePath::cubeTile(i % 6, level, column, static_cast<std::uint32_t>((next() >> 33) % cells));
    const TileBounds bounds = tileBounds(path, 1737400.0, {-9000.0 + i, 10000.0}, 1728000.0);
    for (const glm::dvec3& p : bounds.hull) mix(p);
    for (const glm::dvec3& p : bounds.box.halfAxes) mix(p);
    mix(bounds.box.center);
    mix(bounds.sphere.center);
    mix(bounds.horizonPoint);
    mix(glm::dvec3(bounds.sphere.radiusMeters, lowestSurfaceRadiusMeters(1737400.0, -9000.0, 64), 0));
  }
  EXPECT_EQ(hash, 3137277706745409617u);
}

// ---- horizon ----

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

TEST(TileBounds, HeightsThatReachTheBodysCentreAreStillBounded) {
  Random random(205);
  for (int level = 0; level <= 30; level += 5) {
    Case c = randomCase(random, level);
    c.heights = {-c.radius, 0.1 * c.radius};
    const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, 0.5 * c.radius);
    EXPECT_TRUE(std::isnan(bounds.horizonPoint.x));
    const std::vector<Plane> planes = supportingPlanes(bounds.hull);
    for (int i = 0; i < 100; ++i) {
      const Vec p(samplePoint(random, c));
      ASSERT_TRUE(boxContains(bounds.box, p));
      ASSERT_LE(length(p - Vec(bounds.sphere.center)), static_cast<long double>(bounds.sphere.radiusMeters));
      for (const Plane& plane : planes) ASSERT_LE(dot(plane.normal, p - Vec(bounds.hull[0])), plane.offset);
    }
  }
}

// ---- lowest surface ----

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

#include "common/tiling/tile_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "tests/unit/common/surface_samples.h"

namespace terrane {
namespace {

using test::boxContains;
using test::Case;
using test::Plane;
using test::Random;
using test::randomCase;
using test::samplePoint;
using test::supportingPlanes;
using test::Vec;

class TileBoundsOf : public testing::TestWithParam<Scheme> {};

TEST_P(TileBoundsOf, EverySurfacePointVertexAndChord) {
  Random random(201);
  for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
    for (int tile = 0; tile < 24; ++tile) {
      const Case c = randomCase(random, level, GetParam());
      SCOPED_TRACE(c.path.text() + " radius " + std::to_string(c.radius) + " heights " +
                   std::to_string(c.heights.minMeters) + " " + std::to_string(c.heights.maxMeters));
      const TileBounds bounds = tileBounds(c.path, c.radius, c.heights, 0.9 * c.radius);
      const std::vector<Plane> planes = supportingPlanes(bounds.hull);
      ASSERT_GE(planes.size(), GetParam() == Scheme::Cube ? 6u : 5u);
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

TEST_P(TileBoundsOf, WhatEveryDescendantDraws) {
  Random random(207);
  for (int level = 0; level < FacePath::kMaxLevel; ++level) {
    for (int tile = 0; tile < 12; ++tile) {
      const Case c = randomCase(random, level, GetParam());
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

INSTANTIATE_TEST_SUITE_P(Schemes, TileBoundsOf, testing::Values(Scheme::Cube, Scheme::Ico),
                         [](const auto& scheme) { return std::string(schemeName(scheme.param)); });

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
  EXPECT_EQ(hash, 2332395005052215904u);
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

}  // namespace
}  // namespace terrane

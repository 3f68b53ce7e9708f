// The law of midpoint displacement: its powers, its noise, and the bounds that follow from it.

#include "server/fields/midpoint_displacement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>
#include <set>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "server/fields/height_field.h"

namespace terrane {
namespace {

constexpr unsigned kSeed = 82;
constexpr std::int64_t kFar = std::int64_t{1} << 36;

TEST(PowerOfLevel, IsExactForIntegersAndCloseForAllElse) {
  EXPECT_EQ(powerOfLevel(1, 2.7), 1.0);
  EXPECT_EQ(powerOfLevel(7, 0), 1.0);
  EXPECT_EQ(powerOfLevel(7, 3), 343.0);
  EXPECT_EQ(powerOfLevel(16, 0.25), 2.0);
  EXPECT_EQ(powerOfLevel(9, 1.5), 27.0);
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> exponents(0, 3);
  for (int k = 0; k < 2000; ++k) {
    const int level = 1 + static_cast<int>(random() % MidpointDisplacement::kFinestGridLevel);
    const double exponent = exponents(random);
    const long double expected = std::pow(static_cast<long double>(level), static_cast<long double>(exponent));
    EXPECT_NEAR(static_cast<double>(powerOfLevel(level, exponent) / expected), 1.0, 1e-13) << level << "^" << exponent;
  }
}

TEST(MidpointDisplacement, FollowsTheLawLevelByLevel) {
  const MidpointDisplacement displacement(100, 2, 1);
  EXPECT_EQ(displacement.largestMeters(0), 100);
  EXPECT_EQ(displacement.largestMeters(1), 50);
  EXPECT_EQ(displacement.largestMeters(3), 100 * 9.0 / 8);
  EXPECT_EQ(displacement.largestMeters(10), 100 * 100.0 / 1024);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double meanA = 0, meanB = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) meanA += a[i], meanB += b[i];
  meanA /= static_cast<double>(a.size());
  meanB /= static_cast<double>(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - meanA) * (b[i] - meanB);
    aa += (a[i] - meanA) * (a[i] - meanA);
    bb += (b[i] - meanB) * (b[i] - meanB);
  }
  return ab / std::sqrt(aa * bb);
}

/// Even, and unrelated from vertex to vertex, level to level and seed to seed, 2^36 vertices from a face's corner as
/// near it. The standard deviation of the mean is 0.577 / sqrt(n), of a correlation 1 / sqrt(n): 5 of them are allowed.
TEST(MidpointDisplacement, IsEvenNoiseAtEveryLevelAndFarFromTheCorner) {
  const int n = 40'000;
  const double fiveSigma = 5 / std::sqrt(n);
  for (const int level : {3, 20, 36}) {
    for (const std::int64_t far : {std::int64_t{0}, kFar}) {
      std::vector<double> noise, beside, above, otherLevel, otherSeed;
      std::set<double> distinct;
      const double scale = MidpointDisplacement(1, 0, 1).largestMeters(level);
      for (int k = 0; k < n; ++k) {
        const VertexKey key{7, far + k % 200, far + k / 200};
        const auto value = [&](std::uint64_t seed, int at, const VertexKey& of) {
          const MidpointDisplacement displacement(1, 0, seed);
          return displacement.meters(at, of) / displacement.largestMeters(at);
        };
        noise.push_back(value(1, level, key));
        beside.push_back(value(1, level, {key.a, key.b + 1, key.c}));
        above.push_back(value(1, level, {key.a, key.b, key.c + 1}));
        otherLevel.push_back(value(1, level - 1, key));
        otherSeed.push_back(value(2, level, key));
        distinct.insert(noise.back());
        ASSERT_LT(std::abs(noise.back()), 1.0000001);
      }
      ASSERT_GT(scale, 0);
      double mean = 0, square = 0;
      for (const double x : noise) mean += x / n, square += x * x / n;
      EXPECT_LT(std::abs(mean), fiveSigma * 0.577);
      EXPECT_NEAR(square, 1.0 / 3, 0.01);
      EXPECT_EQ(distinct.size(), noise.size());
      for (const auto* other : {&beside, &above, &otherLevel, &otherSeed})
        EXPECT_LT(std::abs(correlation(noise, *other)), fiveSigma) << level;
    }
  }
}

TEST(MidpointDisplacement, BoundsSumWhatIsLeftOut) {
  const MidpointDisplacement displacement(1000, 1, 1);
  double sum = 0;
  for (int level = MidpointDisplacement::kFinestGridLevel; level >= 0; --level) {
    EXPECT_GE(displacement.largestSumMeters(level, MidpointDisplacement::kFinestGridLevel), sum);
    EXPECT_NEAR(displacement.largestSumMeters(level, MidpointDisplacement::kFinestGridLevel), sum, 1e-9);
    sum += displacement.largestMeters(level);
  }
  EXPECT_GE(displacement.largestHeightMeters(), sum);
  EXPECT_NEAR(displacement.largestHeightMeters(), 3000, 1e-3);  // 1 + the sum of l / 2^l
  EXPECT_EQ(displacement.largestSumMeters(12, 12), 0);
  EXPECT_EQ(displacement.largestSumMeters(12, 9), 0);
}

/// What mostAmplitudeMeters promises follows from largestReliefMeters and largestRiseMeters, for every body and
/// regularity that a scene may name; and a little more would not do. (midpoint_field_test holds those two to tiles.)
TEST(MidpointDisplacement, MostAmplitudeKeepsReliefAndSlopeOfEveryBodyInBounds) {
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    for (const double radius : {kMinRadiusMeters, 1e4, 1.7374e6, 3.3895e6, 6.371e6, kMaxRadiusMeters}) {
      double before = radius;
      for (const double regularity : {0.0, 0.5, 1.0, 2.0, 3.0}) {
        const double most = mostAmplitudeMeters(radius, scheme, regularity);
        const MidpointDisplacement displacement(most, regularity, 1);
        double room = 0, slope = 0;
        for (int level = 0; level <= maxLevel(radius, scheme); ++level) {
          const double width = nominalTileWidthMeters(radius, level, scheme);
          const double apart =
              std::hypot(displacement.largestReliefMeters(scheme, level), farthestPoints(scheme) * width);
          room = std::max(room, apart / (kTileOffsetMax * stepMeters(stepExponent(radius, level, scheme))));
          slope = std::max(slope, displacement.largestRiseMeters(level + 7) / (width / 128));
        }
        const double height = displacement.largestHeightMeters() / radius;
        EXPECT_LE(room, 0.9901);
        EXPECT_LE(slope, 0.95 * kSteepestSlope);
        EXPECT_LE(height, kMostHeight * 1.0000001);
        EXPECT_TRUE(room > 0.9899 || slope > 0.7 * kSteepestSlope || height > 0.9999 * kMostHeight);
        EXPECT_LT(most, before) << "rougher ground must be lower";
        before = most;
        if (radius == 1.7374e6)
          std::printf("%s, regularity %.1f: %.4g m\n", schemeName(scheme).data(), regularity, most);
      }
    }
  }
}

/// Of all tiles and cells of the first levels, by which the constants are the extremes.
TEST(MidpointDisplacement, KnowsHowFarApartATilesPointsAreAndHowLongItsShortestEdge) {
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    double farthest = 0, shortest = 2;
    for (int level = 0; level <= 7; ++level) {
      const double width = nominalTileWidthMeters(1.0, level, scheme);
      const std::int64_t whole = std::int64_t{1} << level;
      for (std::int64_t j = 0; j < whole; ++j) {
        for (std::int64_t i = 0; i < (scheme == Scheme::Cube ? whole : whole - j); ++i) {
          const auto at = [&](std::int64_t x, std::int64_t y) {
            if (scheme == Scheme::Ico) return icoGridDirection(kIcoMap, 0, level, {whole - x - y, x, y});
            return cubeGridDirection(0, level, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
          };
          const glm::dvec3 a = at(i, j), b = at(i + 1, j), c = at(i, j + 1);
          for (const double edge : {glm::length(b - a), glm::length(c - a), glm::length(c - b)}) {
            farthest = std::max(farthest, edge / width);
            shortest = std::min(shortest, edge / width);
          }
          if (scheme == Scheme::Cube) farthest = std::max(farthest, glm::length(at(i + 1, j + 1) - a) / width);
        }
      }
    }
    std::printf("%s: %.4f to %.4f widths\n", schemeName(scheme).data(), shortest, farthest);
    EXPECT_GE(shortest, scheme == Scheme::Cube ? 0.7071 : 0.9497);
    EXPECT_LE(farthest * (1 + kMostHeight), farthestPoints(scheme));
    EXPECT_GE(farthest * (1 + kMostHeight), 0.99 * farthestPoints(scheme));
  }
}

}  // namespace
}  // namespace terrane

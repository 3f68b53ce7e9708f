// The bounds of ground by midpoint displacement against what finer levels and neighbours really do, and how rough it
// is.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "tests/unit/fields/midpoint_ground.h"

namespace terrane {
namespace {

using namespace test;

class MidpointBounds : public MidpointGround {};
INSTANTIATE_TEST_SUITE_P(Schemes, MidpointBounds, bothSchemes(), nameOfScheme);

/// Between vertices the surface of a level is no farther from that of any finer one than omittedAmplitudeMeters says.
/// Directions are those of the finest vertices, where the two differ most.
TEST_P(MidpointBounds, LeavesOutNoMoreThanItSays) {
  double closest = 0;
  for (int coarse = 0; coarse <= 24; coarse += 4) {
    for (const int finer : {1, 2, 5}) {
      const int fine = coarse + finer;
      const double bound = field_->omittedAmplitudeMeters(2 * cellMeters(body_, coarse), 2 * cellMeters(body_, fine));
      for (int k = 0; k < 8; ++k) {
        const FacePath path = randomTileOf(random_, scheme(), std::max(0, fine - 5));
        const int cells = 1 << (fine - path.level());
        const std::vector<glm::dvec3> points = directionsOf(path, cells);
        const SurfaceSamples below = sampledPoints(*field_, body_, points, coarse);
        const SurfaceSamples above = sampledTile(*field_, body_, path, cells);
        for (std::size_t i = 0; i < points.size(); ++i) {
          const double apart = std::abs(above.heightMeters[i] - below.heightMeters[i]);
          ASSERT_LE(apart, bound + 1e-7) << "of grid level " << coarse << " against " << fine;
          if (finer == 1) closest = std::max(closest, apart / bound);
        }
      }
    }
  }
  std::printf("one level leaves out up to %.4f of its bound\n", closest);
  EXPECT_GT(closest, 0.99) << "a bound that nothing comes near holds nothing";
}

TEST_P(MidpointBounds, HasNoInterpolationErrorOnItsOwnGridAndTheFinerLevelsElsewhere) {
  const double cell = cellMeters(body_, 12);
  EXPECT_EQ(field_->interpolationErrorMeters(2 * cell, cell), 0);
  EXPECT_EQ(field_->interpolationErrorMeters(2 * cell, cell / 2), 0);
  EXPECT_EQ(field_->interpolationErrorMeters(2 * cell, 4 * cell), field_->omittedAmplitudeMeters(8 * cell, 2 * cell));
}

TEST_P(MidpointBounds, StaysWithinItsRange) {
  const HeightRange range = field_->heightRange();
  double lowest = 0, highest = 0;
  for (int k = 0; k < 200; ++k) {
    const SurfaceSamples samples = sampledTile(*field_, body_, randomTileOf(random_, scheme(), k % 4), 32);
    lowest = std::min(lowest, *std::ranges::min_element(samples.heightMeters));
    highest = std::max(highest, *std::ranges::max_element(samples.heightMeters));
  }
  std::printf("heights %.0f to %.0f m of %.0f to %.0f m\n", lowest, highest, range.minMeters, range.maxMeters);
  EXPECT_GE(lowest, range.minMeters);
  EXPECT_LE(highest, range.maxMeters);
  EXPECT_GT(highest - lowest, 0.3 * (range.maxMeters - range.minMeters));
}

/// Of neighbours' heights, by whether the field's largest slopes and reliefs are ever exceeded, on bodies of all sizes
/// at the largest amplitude that is allowed.
TEST_P(MidpointBounds, IsNoSteeperThanItSays) {
  double steepest = 0, deepest = 0;
  for (const double radius : {kMinRadiusMeters, kMoonRadius, kMaxRadiusMeters}) {
    for (const double regularity : {0.0, 1.0, 3.0}) {
      const Body body = midpointBody(scheme(), radius, regularity);
      const auto field = makeHeightField(body, bestSimdPath());
      const MidpointDisplacement displacement = displacementOf(body);
      for (int level = 0; level <= maxLevel(radius, scheme()); ++level) {
        const FacePath path = randomTileOf(random_, scheme(), level);
        const SurfaceSamples samples = sampledTile(*field, body, path, 16);
        const auto [low, high] = std::ranges::minmax_element(samples.heightMeters);
        ASSERT_LE(*high - *low, displacement.largestReliefMeters(scheme(), level));
        deepest = std::max(deepest, (*high - *low) / nominalTileWidthMeters(radius, level, scheme()));
        const std::vector<glm::dvec3> at = directionsOf(path, 16);
        for (std::size_t i = 0; i < 16; ++i) {
          const double rise = std::abs(samples.heightMeters[i + 1] - samples.heightMeters[i]);
          ASSERT_LE(rise, displacement.largestRiseMeters(level + 4));
          const double slope = rise / (radius * glm::length(at[i + 1] - at[i]));
          ASSERT_LE(slope, kSteepestSlope);
          steepest = std::max(steepest, slope);
        }
      }
    }
  }
  std::printf("steepest edge %.2f of %.1f, deepest tile %.2f widths\n", steepest, kSteepestSlope, deepest);
}

/// More regularity puts more of the ground's unevenness into small scales.
TEST_P(MidpointBounds, IsRougherInDetailTheLargerTheRegularity) {
  double before = 0;
  for (const double regularity : {0.0, 0.5, 1.0, 2.0, 3.0}) {
    const Body body = midpointBody(scheme(), kMoonRadius, regularity);
    const auto field = makeHeightField(body, bestSimdPath());
    const auto slope = [&](int level) {
      double squares = 0;
      int count = 0;
      for (int k = 0; k < 30; ++k) {
        const SurfaceSamples samples = sampledTile(*field, body, randomTileOf(random_, scheme(), level), 16);
        for (std::size_t i = 0; i < 16; ++i, ++count)
          squares += std::pow((samples.heightMeters[i + 1] - samples.heightMeters[i]) / cellMeters(body, level + 4), 2);
      }
      return std::sqrt(squares / count);
    };
    const double coarse = slope(4), fine = slope(24), ratio = fine / coarse;
    std::printf("regularity %.1f: slopes %.4f at grid level 8, %.4f at 28\n", regularity, coarse, fine);
    EXPECT_GT(ratio, before);
    before = ratio;
  }
}

TEST(MidpointAmplitude, IsRefusedBeyondTheLargest) {
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    EXPECT_FALSE(checkHeightField(midpointBody(scheme)).has_error());
    const Result<void> checked = checkHeightField(midpointBody(scheme, kMoonRadius, 1, 1.0001));
    ASSERT_TRUE(checked.has_error());
    EXPECT_EQ(checked.error().field, "midpoint.amplitude");
    EXPECT_EQ(checked.error().kind, ErrorKind::TooLarge);
  }
}

}  // namespace
}  // namespace terrane

// Craters and rocks on their hashed grids: the geometry that the bounds stand on, and that nothing is lost or double.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "common/tiling/cube_sphere.h"
#include "server/fields/feature_layers.h"
#include "server/fields/lunar_bounds.h"
#include "tests/unit/fields/field_samples.h"

namespace terrane::lunar {
namespace {

using terrane::test::kMoonRadius;
using terrane::test::randomDirection;

std::vector<FeatureLayer> crowdedLayers() { return makeLayers({kMoonRadius, 1.0, 4.0, 0.001, 1969}); }

glm::dvec3 centerOf(const Feature& f) { return {f.center[0], f.center[1], f.center[2]}; }

void gather(const FeatureLayer& layer, const glm::dvec3& at, double radius, std::vector<Feature>& out) {
  out.clear();
  gatherFeatures(layer, kMoonRadius, PatchTarget(Ball{{at.x, at.y, at.z}, radius}), out);
}

/// A feature's bowl or body, with its outline's widest lobe.
double bowlRadius(const FeatureLayer& layer, const Feature& f) {
  return f.radius / (1 - (layer.stage == FeatureStage::Rock ? kRockLobes : kCraterLobes));
}

TEST(FeatureLayers, NoTwoBowlsOfALayerOverlapAndAtMostFourFeaturesTouchAPoint) {
  std::mt19937_64 random(3);
  std::vector<Feature> features;
  std::size_t most = 0;
  for (const FeatureLayer& layer : crowdedLayers()) {
    for (int i = 0; i < 60; ++i) {
      glm::dvec3 d = randomDirection(random);
      // Corners and edges of the cube are the hard places: cells are narrowest there.
      if (i % 3 == 0)
        d = glm::normalize(glm::sign(d) + 2e-2 * layer.largestDiameter() / kMoonRadius * randomDirection(random));
      if (i % 3 == 1) d = glm::normalize(glm::dvec3(1, 1, 0.02 * d.z));
      gather(layer, d * kMoonRadius, layer.largestDiameter() * 2, features);
      for (std::size_t a = 0; a < features.size(); ++a) {
        for (std::size_t b = a + 1; b < features.size(); ++b) {
          ASSERT_GE(glm::distance(centerOf(features[a]), centerOf(features[b])),
                    (bowlRadius(layer, features[a]) + bowlRadius(layer, features[b])) * (1 - 1e-9));
        }
      }
      for (int k = 0; k < 40; ++k) {
        const glm::dvec3 p =
            glm::normalize(d * kMoonRadius + layer.largestDiameter() * randomDirection(random)) * kMoonRadius;
        std::size_t touching = 0;
        for (const Feature& f : features) touching += glm::distance(centerOf(f), p) < f.reach;
        most = std::max(most, touching);
        ASSERT_LE(touching, 4u);
      }
    }
  }
  std::printf("most features of a layer at one point: %zu\n", most);
  EXPECT_GE(most, 3u);
}

TEST(FeatureLayers, GatheringFindsAllThatCellByCellSearchFinds) {
  std::mt19937_64 random(5);
  for (const FeatureLayer& layer : crowdedLayers()) {
    if (layer.cellsPerFace > 60) continue;
    std::vector<Feature> all, near;
    for (int face = 0; face < 6; ++face) {
      for (std::uint32_t row = 0; row < layer.cellsPerFace; ++row) {
        for (std::uint32_t column = 0; column < layer.cellsPerFace; ++column) {
          Feature f;
          if (featureOfCell(layer, kMoonRadius, face, column, row, f)) all.push_back(f);
        }
      }
    }
    for (int i = 0; i < 30; ++i) {
      const glm::dvec3 p = randomDirection(random) * kMoonRadius;
      const double ball = i % 2 ? 1000.0 : 400000.0;
      gather(layer, p, ball, near);
      std::vector<glm::dvec3> expected;
      for (const Feature& f : all) {
        if (glm::distance(centerOf(f), p) <= ball + f.reach) expected.push_back(centerOf(f));
      }
      ASSERT_EQ(near.size(), expected.size()) << "exponent " << layer.exponent;
      for (std::size_t k = 0; k < near.size(); ++k) ASSERT_EQ(centerOf(near[k]), expected[k]);
    }
  }
}

TEST(FeatureLayers, SmallLayersAreGatheredTheSameFromEveryBall) {
  std::mt19937_64 random(9);
  std::vector<Feature> wide, narrow;
  for (const FeatureLayer& layer : crowdedLayers()) {
    for (int i = 0; i < 20; ++i) {
      glm::dvec3 d = randomDirection(random);
      if (i % 2) d = glm::normalize(glm::dvec3(d.x > 0 ? 1 : -1, 1, i % 4 == 1 ? 1 : d.z));
      const double size = layer.largestDiameter();
      gather(layer, d * kMoonRadius, 6 * size, wide);
      const glm::dvec3 inside = glm::normalize(d * kMoonRadius + 3 * size * randomDirection(random)) * kMoonRadius;
      gather(layer, inside, size, narrow);
      std::size_t expected = 0;
      for (const Feature& f : wide) expected += glm::distance(centerOf(f), inside) <= size + f.reach;
      ASSERT_EQ(narrow.size(), expected) << "exponent " << layer.exponent;
    }
  }
}

// Rows of the tiles' sizes and larger, anywhere: over edges and corners of faces, and round a third of the body.
TEST(FeatureLayers, ARowFindsWhatTouchesItsPointsInTheOrderOfTheBall) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> sizes(2, 40);
  std::size_t around = 0, near = 0, touching = 0;
  for (const FeatureLayer& layer : crowdedLayers()) {
    for (int i = 0; i < 10; ++i) {
      const glm::dvec3 start = i < 3 ? glm::normalize(glm::dvec3(1, i % 2 ? 1 : -1, i)) : randomDirection(random);
      const double length = std::min(sizes(random) * layer.largestDiameter() / kMoonRadius, 1.5);
      const glm::dvec3 end = glm::normalize(start + length * randomDirection(random));
      std::vector<double> x, y, z;
      for (int k = 0; k <= 64; ++k) {
        const glm::dvec3 p = glm::normalize(start + (end - start) * (k / 64.0));
        x.push_back(p.x);
        y.push_back(p.y);
        z.push_back(p.z);
      }
      const glm::dvec3 middle = glm::normalize(start + end) * kMoonRadius;
      const Ball ball{{middle.x, middle.y, middle.z}, 1.001 * glm::distance(middle, start * kMoonRadius)};
      std::vector<Feature> ofBall, ofRow;
      gatherFeatures(layer, kMoonRadius, PatchTarget(ball), ofBall);
      gatherFeatures(layer, kMoonRadius, RowTarget({x.data(), y.data(), z.data(), x.size(), kMoonRadius, ball}), ofRow);
      std::size_t next = 0;
      for (const Feature& f : ofBall) {
        const bool found = next < ofRow.size() && centerOf(ofRow[next]) == centerOf(f);
        next += found ? 1 : 0;
        for (std::size_t k = 0; k < x.size(); ++k) {
          if (glm::distance(glm::dvec3(x[k], y[k], z[k]) * kMoonRadius, centerOf(f)) > f.reach) continue;
          ASSERT_TRUE(found) << "exponent " << layer.exponent << ", row " << i;
          ++touching;
          break;
        }
      }
      ASSERT_EQ(next, ofRow.size()) << "what the ball has not, or in another order";
      around += ofBall.size();
      near += ofRow.size();
    }
  }
  std::printf("in the ball %zu, near the row %zu, touching its points %zu\n", around, near, touching);
  EXPECT_LT(near, around / 2);
}

/// A square of so many points each way, its middle and side as directions: all of it, or its border.
std::vector<glm::dvec3> squareAround(const glm::dvec3& middle, const glm::dvec3& side, double half, bool whole) {
  const glm::dvec3 other = glm::cross(middle, side);
  constexpr int kCells = 12;
  std::vector<glm::dvec3> points;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      if (!whole && i % kCells != 0 && j % kCells != 0) continue;
      const double u = 2.0 * i / kCells - 1, v = 2.0 * j / kCells - 1;
      points.push_back(glm::normalize(middle + half * (u * side + v * other)));
    }
  }
  return points;
}

// Of tiles of all sizes, from the border alone, over edges and corners of faces too.
TEST(FeatureLayers, APatchFindsWhatTouchesThePointsThatItsBorderEncloses) {
  std::mt19937_64 random(14);
  std::uniform_real_distribution<double> sizes(1, 30);
  std::size_t around = 0, near = 0, touching = 0;
  for (const FeatureLayer& layer : crowdedLayers()) {
    for (int i = 0; i < 10; ++i) {
      const glm::dvec3 middle =
          i < 4 ? glm::normalize(glm::dvec3(1, i % 2 ? 1 : -1, 0.3 * i)) : randomDirection(random);
      const glm::dvec3 side = glm::normalize(glm::cross(middle, randomDirection(random)));
      const double half = std::min(sizes(random) * layer.largestDiameter() / kMoonRadius, 0.5);
      std::vector<double> x, y, z;
      Ball ball{{middle.x * kMoonRadius, middle.y * kMoonRadius, middle.z * kMoonRadius}, 0};
      for (const glm::dvec3& p : squareAround(middle, side, half, false)) {
        x.push_back(p.x);
        y.push_back(p.y);
        z.push_back(p.z);
        ball.radius = std::max(ball.radius, 1.001 * kMoonRadius * glm::distance(p, middle));
      }
      const PatchTarget patch({x.data(), y.data(), z.data(), x.size(), kMoonRadius, ball}, 0);
      std::vector<Feature> ofBall, ofPatch;
      gatherFeatures(layer, kMoonRadius, PatchTarget(ball), ofBall);
      gatherFeatures(layer, kMoonRadius, patch, ofPatch);
      const std::vector<glm::dvec3> all = squareAround(middle, side, half, true);
      std::size_t next = 0;
      for (const Feature& f : ofBall) {
        const bool found = next < ofPatch.size() && centerOf(ofPatch[next]) == centerOf(f);
        next += found ? 1 : 0;
        const auto touches = [&](const glm::dvec3& p) {
          return glm::distance(p * kMoonRadius, centerOf(f)) <= f.reach;
        };
        if (std::ranges::none_of(all, touches)) continue;
        ASSERT_TRUE(found) << "exponent " << layer.exponent << ", patch " << i;
        ++touching;
      }
      ASSERT_EQ(next, ofPatch.size()) << "what the ball has not, or in another order";
      around += ofBall.size();
      near += ofPatch.size();
    }
  }
  std::printf("in the ball %zu, near the patch %zu, touching its points %zu\n", around, near, touching);
  EXPECT_LT(near, around);
}

TEST(FeatureLayers, APatchHoldsItsPointsAndNoneBesideThem) {
  std::mt19937_64 random(15);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 middle = randomDirection(random);
    const double half = std::exp2(-3.0 - i % 20);
    // Along the face's own axes, as a cube's tiles lie.
    const FaceCoordinates at = cubeFaceCoordinates(middle);
    std::vector<double> axes[3], outside[3];
    Ball ball{{middle.x * kMoonRadius, middle.y * kMoonRadius, middle.z * kMoonRadius}, 3 * half * kMoonRadius};
    for (const double u : {-1.0, 0.0, 1.0}) {
      for (const double v : {-1.0, 0.0, 1.0}) {
        const glm::dvec3 in = cubeDirection(at.face, at.s + half * u, at.t + half * v);
        const glm::dvec3 out = cubeDirection(at.face, at.s + half * (u + 0.2), at.t + half * v);
        for (int a = 0; a < 3; ++a) {
          axes[a].push_back(in[a]);
          outside[a].push_back(out[a]);
        }
      }
    }
    const PointSet in{axes[0].data(), axes[1].data(), axes[2].data(), axes[0].size(), kMoonRadius, ball};
    const PointSet out{outside[0].data(), outside[1].data(), outside[2].data(), outside[0].size(), kMoonRadius, ball};
    const PatchTarget patch(in, 0.005);
    EXPECT_TRUE(patch.holds(in));
    EXPECT_FALSE(patch.holds(out));
  }
}

TEST(FeatureLayers, HalosAreThoseOfTheYoungestCratersFromEveryBall) {
  std::mt19937_64 random(11);
  std::size_t found = 0;
  for (const FeatureLayer& layer : crowdedLayers()) {
    for (int i = 0; i < 10; ++i) {
      const glm::dvec3 d = randomDirection(random), at = d * kMoonRadius;
      const double size = layer.largestDiameter(), ball = 8 * size;
      const glm::dvec3 inside = glm::normalize(at + 2 * size * randomDirection(random)) * kMoonRadius;
      std::vector<Halo> wide, narrow;
      std::vector<Feature> craters;
      gatherHalos(layer, kMoonRadius, PatchTarget(Ball{{at.x, at.y, at.z}, ball}), wide);
      gatherHalos(layer, kMoonRadius, PatchTarget(Ball{{inside.x, inside.y, inside.z}, size}), narrow);
      gather(layer, at, ball, craters);
      std::erase_if(craters, [&](const Feature& f) { return glm::distance(centerOf(f), at) > ball; });
      std::size_t expected = 0;
      for (const Halo& h : wide) {
        const glm::dvec3 middle(h.center[0], h.center[1], h.center[2]);
        expected += glm::distance(middle, inside) <= size + h.reach;
        ASSERT_GT(h.brightness, 0.0f);
        const auto around = [&](const Feature& f) { return centerOf(f) == middle && f.radius == h.radius; };
        ASSERT_EQ(std::ranges::count_if(craters, around), glm::distance(middle, at) <= ball ? 1 : 0);
      }
      ASSERT_EQ(narrow.size(), expected) << "exponent " << layer.exponent;
      ASSERT_TRUE(wide.empty() || layer.hasHalos());
      found += wide.size();
    }
  }
  EXPECT_GT(found, 500u);
}

TEST(FeatureLayers, FreshCratersHaveThePublishedDepths) {
  // Stopar et al. 2017 and Pike 1977; between the published sizes the table is linear.
  EXPECT_NEAR(freshCrater(50).depth / 50, 0.12, 0.012);
  EXPECT_NEAR(freshCrater(150).depth / 150, 0.15, 0.015);
  EXPECT_NEAR(freshCrater(400).depth / 400, 0.19, 0.015);
  EXPECT_NEAR(freshCrater(4000).depth / 4000, 0.20, 0.01);
  for (const double diameter : {30.0, 90.0, 200.0}) {
    EXPECT_NEAR(freshCrater(diameter * 1000).depth, 1044 * std::pow(diameter, 0.301),
                0.04 * 1044 * std::pow(diameter, 0.301));
    EXPECT_NEAR(freshCrater(diameter * 1000).rim, 236 * std::pow(diameter, 0.399),
                0.05 * 236 * std::pow(diameter, 0.399));
  }
}

TEST(FeatureLayers, SizesFollowTheInverseSquareLaw) {
  const auto layers = makeLayers({kMoonRadius, 1.0, 1.0, 0.001, 5});
  std::map<int, std::pair<int, int>> counts;  // exponent: all, larger than 1.5 D0
  for (const FeatureLayer& layer : layers) {
    if (layer.stage != FeatureStage::YoungCrater || layer.exponent > 6) continue;
    auto& [all, large] = counts[layer.exponent];
    for (std::uint32_t row = 1000; row < 1060; ++row) {
      for (std::uint32_t column = 2000; column < 2060; ++column) {
        Feature f;
        if (!featureOfCell(layer, kMoonRadius, 1, column, row, f)) continue;
        ++all;
        large += 2 * f.radius > 1.5 * layer.smallestDiameter();
      }
    }
  }
  // N(> 1.5) / N(> 1) within [1, 2): (1.5^-2 - 2^-2) / (1 - 2^-2) = 0.2593.
  for (const auto& [exponent, count] : counts) {
    EXPECT_NEAR(static_cast<double>(count.second) / count.first, 0.2593, 0.03) << exponent;
  }
}

}  // namespace
}  // namespace terrane::lunar

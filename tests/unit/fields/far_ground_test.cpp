// Ground that is not mixed: found only where one of land and lava hides the other for certain, and then the shorter
// sums of the kernels are the longer ones.

#include "server/fields/far_ground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "server/fields/far_feature.h"
#include "server/fields/far_fit.h"
#include "server/fields/far_patch.h"
#include "server/fields/feature_layers.h"
#include "tests/unit/fields/field_samples.h"

namespace terrane::lunar {
namespace {

using namespace terrane::test;

constexpr double kDepth = 200;  ///< of the old crater of these tests

/// The Moon's constants at a fine level, with nothing near.
Program nothingNear() {
  Program program{};
  program.radius = kMoonRadius;
  program.minWavelength = 1;
  program.footprint = 0.5;
  program.lavaTop = -2050;
  program.lavaFloor = -8050;
  program.lavaBlend = 220;
  program.clampLow = -8500;
  program.clampHigh = 8500;
  program.clampBlend = 3500;
  program.mareSmoothing = 0.6;
  program.inverseReliefAmplitude = 1.0 / 3000;
  return program;
}

/// A tile's patch some hundred metres wide.
FarPatch smallPatch(const glm::dvec3& direction) {
  const glm::dvec3 side = glm::normalize(glm::cross(direction, glm::dvec3(0.3, -0.5, 0.8)));
  const glm::dvec3 other = glm::cross(direction, side);
  std::vector<double> x, y, z;
  for (const double v : {-5e-5, 5e-5}) {
    for (const double u : {-5e-5, 5e-5}) {
      const glm::dvec3 p = glm::normalize(direction + u * side + v * other);
      x.push_back(p.x);
      y.push_back(p.y);
      z.push_back(p.z);
    }
  }
  const glm::dvec3 middle = direction * kMoonRadius;
  return patchAround({x.data(), y.data(), z.data(), 4, kMoonRadius, {{middle.x, middle.y, middle.z}, 125}}, 2,
                     kMoonRadius);
}

/// Nothing but dryness and relief: its mean height above the lava's level, and how far it goes from that.
FarExpansion groundAt(const FarPatch& patch, const Program& program, double dry, double above, double change) {
  static Block nodes;
  const double relief = program.lavaTop - (program.lavaTop - program.lavaFloor) * dry + above;
  std::fill(nodes.relief, nodes.relief + kFarNodeCount, relief);
  std::fill(nodes.dry, nodes.dry + kFarNodeCount, dry);
  FarExpansion far;
  fitExpansion(patch, nodes, far);
  far.relief.isConstant = false;
  far.relief.coefficients[1] = change;
  return far;
}

class FarGroundTest : public ::testing::Test {
 protected:
  FarPatch patch_ = smallPatch(glm::normalize(glm::dvec3(0.3, 0.5, -0.7)));
  Program near_ = nothingNear();

  FarGround groundOf(FarExpansion far) const {
    simplifyGround(near_, patch_.ball, far);
    return far.ground;
  }
  FarGround groundOf(double dry, double above, double change) const {
    return groundOf(groundAt(patch_, near_, dry, above, change));
  }
};

TEST_F(FarGroundTest, IsMixedUnlessOneHidesTheOtherByMoreThanTheirBlend) {
  EXPECT_EQ(groundOf(0, 321, 100), FarGround::Land);
  EXPECT_EQ(groundOf(0, 319, 100), FarGround::Mixed);
  EXPECT_EQ(groundOf(0, -319, 100), FarGround::Mixed);
  EXPECT_EQ(groundOf(0, -321, 100), FarGround::Lava);
  EXPECT_EQ(groundOf(0.5, 3000, 0), FarGround::Mixed) << "the lava's edge calms regolith more here than there";
  EXPECT_EQ(groundOf(1, 6000, 0), FarGround::Land);
}

TEST_F(FarGroundTest, IsMixedNearTheClampAndWhereCoastsAreSmearedOut) {
  EXPECT_EQ(groundOf(0, 6900, 100), FarGround::Land);
  EXPECT_EQ(groundOf(0, 6960, 100), FarGround::Mixed) << "its top is less than the clamp's blend below the clamp";
  near_.footprint = 400;
  FarExpansion steep = groundAt(patch_, near_, 0, 300, 0);
  EXPECT_EQ(groundOf(steep), FarGround::Land);
  steep.reliefX.coefficients[0] = 0.6f;
  EXPECT_EQ(groundOf(steep), FarGround::Mixed) << "half the width of the coast is 360 m of height";
}

TEST_F(FarGroundTest, WhatIsNearCountsByWhatItMayAddHere) {
  const auto withCrater = [&](double distance, FeatureStage stage, double above) {
    const glm::dvec3 origin(patch_.origin[0], patch_.origin[1], patch_.origin[2]);
    const glm::dvec3 side(patch_.axisA[0], patch_.axisA[1], patch_.axisA[2]);
    const glm::dvec3 center = glm::normalize(origin + side * distance);
    const Feature crater = makeCrater(&center.x, kMoonRadius, 3000, 0.5, 7);
    EXPECT_GT(crater.rim - crater.floor, kDepth);
    const FeatureRun run{&crater, 1, stage, true};
    near_.runs = &run;
    near_.runCount = 1;
    return groundOf(0, above, 10);
  };
  EXPECT_EQ(withCrater(0, FeatureStage::OldCrater, 230 + 0.5 * kDepth), FarGround::Mixed) << "its floor is flooded";
  EXPECT_EQ(withCrater(2500, FeatureStage::OldCrater, 230 + 0.5 * kDepth), FarGround::Land) << "its ejecta are not";
  EXPECT_EQ(withCrater(0, FeatureStage::OldCrater, 230 + 3 * kDepth), FarGround::Land);
  EXPECT_EQ(withCrater(0, FeatureStage::YoungCrater, 230 + 0.5 * kDepth), FarGround::Land) << "younger than the lava";
}

TEST_F(FarGroundTest, CratersAddNoMoreToAPatchThanTheirSpan) {
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> unit;
  static Block block;
  double widest = 0, narrow = 0;
  constexpr int kCraters = 3000;
  for (int i = 0; i < kCraters; ++i) {
    const glm::dvec3 center = randomDirection(random);
    const double diameter = std::exp2(9 + 8 * unit(random)), wear = unit(random);
    const Feature crater = makeCrater(&center.x, kMoonRadius, diameter, wear, random());
    const glm::dvec3 side = glm::normalize(glm::cross(center, randomDirection(random)));
    const double distance = 2.6 * crater.radius * unit(random);
    const FarPatch patch = smallPatch(glm::normalize(center + side * (distance / kMoonRadius)));
    const FeatureRun run{&crater, 1, FeatureStage::OldCrater, true};
    Program program = nothingNear();
    program.lavaTop = program.lavaFloor = -1e5;
    program.runs = &run;
    program.runCount = 1;
    const HeightSpan span = craterSpan(crater, program, patch.ball);
    block.count = kChunk;
    for (std::size_t k = 0; k < kChunk; ++k) {
      double p[3];
      const double a = 2 * unit(random) - 1, b = 2 * unit(random) - 1;
      patch.pointAt(a, b, p);
      block.x[k] = p[0];
      block.y[k] = p[1];
      block.z[k] = p[2];
    }
    evaluateBlockDefault(program, block);
    for (std::size_t k = 0; k < kChunk; ++k) {
      ASSERT_GE(block.relief[k], span.low - 1e-9) << i;
      ASSERT_LE(block.relief[k], span.high + 1e-9) << i;
    }
    const double whole = crater.rim - crater.floor;
    narrow += span.high - span.low < 0.5 * whole ? 1.0 / kCraters : 0;
    widest = std::max(widest, (span.high - span.low) / whole);
  }
  std::printf("%.0f %% of the spans are less than half of the crater's, the widest %.2f of it\n", 100 * narrow, widest);
  EXPECT_GT(narrow, 0.4);
}

/// Far sums of all kinds; the kernels' own sums are polynomials of it.
FarExpansion variedGround(std::mt19937_64& random, const FarPatch& patch, const Program& program, double dry,
                          double above) {
  std::uniform_real_distribution<double> unit(-1, 1);
  FarExpansion far = groundAt(patch, program, dry, above, 0);
  const auto vary = [&](auto& polynomial, double size) {
    polynomial.isConstant = false;
    for (auto& c : polynomial.coefficients) {
      const double change = size * unit(random);
      c += static_cast<std::decay_t<decltype(c)>>(change);
    }
  };
  for (FarHeight* height : {&far.relief, &far.lava, &far.young, &far.rough}) vary(*height, 2);
  for (FarSlope* slope : {&far.reliefX, &far.reliefY, &far.reliefZ, &far.lavaX, &far.lavaY, &far.lavaZ, &far.youngX,
                          &far.youngY, &far.youngZ, &far.roughX, &far.roughY, &far.roughZ, &far.mottle})
    vary(*slope, 0.02);
  vary(far.bright, 0.001);
  return far;
}

struct Differences {
  double height = 0, slope = 0, reflectance = 0;
};

/// Of the block with an expansion as it is and with it simplified.
Differences differencesOf(const Program& near, const FarPatch& patch, const FarExpansion& mixed,
                          const FarExpansion& simple) {
  static Block one, other;
  Program program = near;
  for (auto [block, far] : {std::pair(&one, &mixed), std::pair(&other, &simple)}) {
    block->count = kBlockCapacity;
    for (std::size_t k = 0; k < kBlockCapacity; ++k) {
      double p[3];
      patch.pointAt(std::sin(static_cast<double>(k)), std::cos(1.7 * static_cast<double>(k)), p);
      block->x[k] = p[0];
      block->y[k] = p[1];
      block->z[k] = p[2];
    }
    program.far = far;
    evaluateBlockDefault(program, *block);
  }
  Differences worst;
  for (std::size_t k = 0; k < kBlockCapacity; ++k) {
    const auto slope = [&](const float* a, const float* b) { return std::abs(static_cast<double>(a[k] - b[k])); };
    worst.height = std::max(worst.height, std::abs(one.height[k] - other.height[k]));
    worst.slope = std::max({worst.slope, slope(one.gradientX, other.gradientX), slope(one.gradientY, other.gradientY),
                            slope(one.gradientZ, other.gradientZ)});
    worst.reflectance = std::max(worst.reflectance, slope(one.reflectance, other.reflectance));
  }
  return worst;
}

TEST_F(FarGroundTest, TheShorterSumsAreTheLongerOnes) {
  std::mt19937_64 random(73);
  Differences worst, forced;
  for (int i = 0; i < 200; ++i) {
    const bool isLand = i % 2 == 0, isDry = i % 4 == 0;
    const double above = isDry ? 6500 : isLand ? 500 : -500;
    const FarExpansion mixed = variedGround(random, patch_, near_, isDry ? 1 : 0, above);
    FarExpansion simple = mixed;
    simplifyGround(near_, patch_.ball, simple);
    ASSERT_EQ(simple.ground, isLand ? FarGround::Land : FarGround::Lava);
    const Differences one = differencesOf(near_, patch_, mixed, simple);
    worst = {std::max(worst.height, one.height), std::max(worst.slope, one.slope),
             std::max(worst.reflectance, one.reflectance)};
    // Control: the same at a coast.
    FarExpansion coast = mixed, taken = simple;
    coast.relief.coefficients[0] -= above;
    if (isLand) taken.relief.coefficients[0] -= above;
    forced.height = std::max(forced.height, differencesOf(near_, patch_, coast, taken).height);
  }
  std::printf("heights differ by %.1e m, slopes by %.1e, reflectance by %.1e; at a coast heights by %.0f m\n",
              worst.height, worst.slope, worst.reflectance, forced.height);
  EXPECT_LE(worst.height, 1e-10);
  EXPECT_LE(worst.slope, 1e-6);
  EXPECT_LE(worst.reflectance, 1e-6);
  EXPECT_GT(forced.height, 1) << "control";
}

}  // namespace
}  // namespace terrane::lunar

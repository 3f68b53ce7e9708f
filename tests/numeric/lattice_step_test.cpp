// The lattice's step and the finest level, for bodies of any size: powers of two and their neighbours among them, where
// a logarithm rounds to the wrong side.

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "common/tiling/lattice.h"
#include "tests/numeric/samples.h"

namespace terrane {
namespace {

constexpr double kLeastRadius = 1.0, kLargestRadius = 1e9;
constexpr double kHalfPi = 1.5707963267948966;

/// From a metre to beyond the Sun: powers of two and the radii whose tiles are powers of two wide, each with its
/// neighbours up to two ulps away; known bodies; and any.
std::vector<double> bodyRadiiMeters() {
  std::vector<double> radii{kLeastRadius, kMinRadiusMeters, 1'737'400.0,      3'389'500.0,   6'371'000.0,
                            6'378'137.0,  69'911'000.0,     kMaxRadiusMeters, kLargestRadius};
  for (double power = 1; power <= kLargestRadius; power *= 2) {
    for (const double middle : {power, power / kHalfPi}) {
      const double below = std::nextafter(middle, 0.0), above = std::nextafter(middle, kLargestRadius);
      for (const double radius : {std::nextafter(below, 0.0), below, middle, above, std::nextafter(above, 1e10)})
        if (radius >= kLeastRadius) radii.push_back(radius);
    }
  }
  std::mt19937_64 random = test::seededRandom(32);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 1000; ++i) radii.push_back(std::pow(kLargestRadius, share(random)));
  return radii;
}

TEST(LatticeStep, IsTheSmallestPowerOfTwoThatSpansATileIn32768) {
  for (const double radius : bodyRadiiMeters()) {
    for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
      const double step = stepMeters(stepExponent(radius, level));
      const double width = nominalTileWidthMeters(radius, level);
      ASSERT_GE(step * 32768.0, width) << radius << " m, level " << level;
      ASSERT_LT(step * 16384.0, width) << radius << " m, level " << level;
    }
  }
  // A width that is a power of two itself takes the step without rounding up; one ulp more takes the next.
  double radius = 1048576.0 / kHalfPi;
  ASSERT_EQ(nominalTileWidthMeters(radius, 0), 1048576.0);
  while (nominalTileWidthMeters(std::nextafter(radius, 1e9), 0) == 1048576.0) radius = std::nextafter(radius, 1e9);
  EXPECT_EQ(stepExponent(radius, 0), 5);
  EXPECT_EQ(stepExponent(std::nextafter(radius, 1e9), 0), 6);
}

TEST(LatticeStep, ByALogarithmWouldBeTooSmallJustAboveAPowerOfTwo) {
  // The control: as the definition is written. log2 of a power of two and one ulp rounds to the power itself.
  int tooSmall = 0, cases = 0;
  for (const double radius : bodyRadiiMeters()) {
    for (int level = 0; level <= FacePath::kMaxLevel; ++level, ++cases) {
      const double width = nominalTileWidthMeters(radius, level);
      tooSmall += std::exp2(std::ceil(std::log2(width / 32768.0))) * 32768.0 < width;
    }
  }
  std::cout << "control, ceil(log2(W / 2^15)): " << tooSmall << " of " << cases << " steps too small\n";
  EXPECT_GT(tooSmall, 100);
}

/// What a 3D Tiles client computes of the root node's matrix, and the value below which it takes it for singular and
/// shades no more (CesiumJS, Matrix3.inverse and Matrix4.inverse).
double determinant(double step) { return step * step * step; }
constexpr double kSmallestDeterminant = 1e-21;

TEST(LatticeStep, AtTheFinestLevelIsOneThatAClientCanShade) {
  int blackWithoutCap = 0, capped = 0;
  for (const double radius : bodyRadiiMeters()) {
    const int level = maxLevel(radius);
    ASSERT_GE(level, 0);
    ASSERT_LE(level, FacePath::kMaxLevel);
    ASSERT_GE(stepMeters(stepExponent(radius, level)), 0x1p-23) << radius;
    ASSERT_GT(determinant(stepMeters(stepExponent(radius, level))), kSmallestDeterminant) << radius;
    if (level == FacePath::kMaxLevel) continue;
    ++capped;
    ASSERT_LT(stepMeters(stepExponent(radius, level + 1)), 0x1p-23) << radius << ": a finer level would do";
    // The control: no cap.
    blackWithoutCap += determinant(stepMeters(stepExponent(radius, level + 1))) < kSmallestDeterminant;
  }
  EXPECT_GT(capped, 500);
  EXPECT_EQ(blackWithoutCap, capped);
  EXPECT_EQ(maxLevel(kMaxRadiusMeters), 30);
  EXPECT_GT(maxLevel(kMinRadiusMeters), 10);
}

}  // namespace
}  // namespace terrane

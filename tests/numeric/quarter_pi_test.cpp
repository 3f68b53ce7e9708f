// The tangent and arc tangent that cube faces are warped by, against MPFR: their stated errors, exact ends, symmetry.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/quarter_pi_polynomials.h"
#include "tests/numeric/samples.h"
#include "tests/support/high_precision.h"

namespace terrane {
namespace {

using Precise = test::HighPrecision;
using test::sameBits;

const Precise& quarterPi() {
  static const Precise value = atan(Precise(1));
  return value;
}

/// Arguments in [0, 1]: uniform, small ones down to 2^-60, and close to both ends and to where the reduction begins.
std::vector<double> arguments(std::uint64_t seed, int count, double fold) {
  std::mt19937_64 random = test::seededRandom(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> out;
  for (int i = 0; i < count; ++i) {
    const double x = unit(random);
    out.push_back(x);
    out.push_back(x * std::ldexp(1.0, -static_cast<int>(random() % 60)));
    out.push_back(1.0 - x * std::ldexp(1.0, -static_cast<int>(random() % 50)));
    out.push_back(std::clamp(fold + (x - 0.5) * 0.02, 0.0, 1.0));
  }
  return out;
}

TEST(QuarterPi, PolynomialsAreMinimaxToTheStatedError) {
  const auto evaluate = [](const auto& coefficients, double high, double low, const Precise& x) {
    Precise sum = 0;
    for (std::size_t i = coefficients.size(); i-- > 0;) sum = sum * x * x + Precise(coefficients[i]);
    return Precise(x * (Precise(high) + Precise(low) + x * x * sum));
  };
  Precise worstTangent = 0;
  Precise worstArcTangent = 0;
  for (int i = 1; i <= 500; ++i) {
    const Precise x = Precise(i) * quarter_pi::kTangentRange / 500;
    const Precise tangent = tan(Precise(x * quarterPi()));
    worstTangent = std::max(
        worstTangent,
        Precise(abs(Precise(
            evaluate(quarter_pi::kTangent, quarter_pi::kTangentHigh, quarter_pi::kTangentLow, x) / tangent - 1))));
    const Precise z = Precise(i) * quarter_pi::kArcTangentRange / 500;
    const Precise angle = atan(z) / quarterPi();
    worstArcTangent = std::max(
        worstArcTangent,
        Precise(abs(Precise(
            evaluate(quarter_pi::kArcTangent, quarter_pi::kArcTangentHigh, quarter_pi::kArcTangentLow, z) / angle -
            1))));
  }
  std::cout << "polynomial error: tan " << static_cast<double>(log2(worstTangent)) << " bits, atan "
            << static_cast<double>(log2(worstArcTangent)) << " bits\n";
  EXPECT_LE(worstTangent, Precise(quarter_pi::kPolynomialError));
  EXPECT_LE(worstArcTangent, Precise(quarter_pi::kPolynomialError));
}

TEST(QuarterPi, TangentIsWithinItsBound) {
  Precise worst = 0;
  double where = 0;
  for (const double x : arguments(101, 1500, quarter_pi::kTangentRange)) {
    if (x == 0) continue;
    const Precise exact = tan(Precise(quarterPi() * x));
    const Precise error = abs(Precise(Precise(tanQuarterPi(x)) / exact - 1));
    if (error > worst) {
      worst = error;
      where = x;
    }
  }
  std::cout << "worst relative error " << static_cast<double>(worst) << " at " << where << '\n';
  EXPECT_LE(worst, Precise(kTanQuarterPiError));
}

TEST(QuarterPi, ArcTangentIsWithinItsBound) {
  Precise worst = 0;
  Precise worstRelative = 0;
  for (const double t : arguments(102, 1500, quarter_pi::kArcTangentRange)) {
    if (t == 0) continue;
    const Precise exact = atan(Precise(t)) / quarterPi();
    const Precise error = abs(Precise(Precise(atanQuarterPi(t)) - exact));
    worst = std::max(worst, error);
    worstRelative = std::max(worstRelative, Precise(error / exact));
  }
  std::cout << "worst error " << static_cast<double>(worst) << ", relative " << static_cast<double>(worstRelative)
            << '\n';
  EXPECT_LE(worst, Precise(kAtanQuarterPiError));
  EXPECT_LE(worstRelative, Precise(kAtanQuarterPiRelativeError));
}

TEST(QuarterPi, EndsAndZeroAreExactAndNothingElseIsStrange) {
  using Limits = std::numeric_limits<double>;
  for (const auto function : {&tanQuarterPi, &atanQuarterPi}) {
    EXPECT_TRUE(sameBits(function(1.0), 1.0));
    EXPECT_TRUE(sameBits(function(-1.0), -1.0));
    EXPECT_TRUE(sameBits(function(0.0), 0.0));
    EXPECT_TRUE(sameBits(function(-0.0), -0.0));
    EXPECT_TRUE(std::isnan(function(Limits::quiet_NaN())));
    // Denormals: nothing finer than the spacing of denormals can be asked for.
    for (const double x : {Limits::denorm_min(), 37 * Limits::denorm_min(), Limits::min() * 0.75, Limits::min()}) {
      const double slope = function == &tanQuarterPi ? 0.78539816339744831 : 1.2732395447351628;
      EXPECT_LE(std::fabs(function(x) - slope * x), Limits::denorm_min());
      EXPECT_TRUE(sameBits(function(-x), -function(x)));
    }
  }
}

TEST(QuarterPi, BothAreOddMonotoneAndInverse) {
  std::vector<double> xs = arguments(103, 5000, quarter_pi::kTangentRange);
  std::sort(xs.begin(), xs.end());
  double last = -1;
  double worst = 0;
  for (const double x : xs) {
    const double t = tanQuarterPi(x);
    ASSERT_TRUE(sameBits(tanQuarterPi(-x), -t));
    ASSERT_TRUE(sameBits(atanQuarterPi(-t), -atanQuarterPi(t)));
    ASSERT_LE(t, 1.0);
    ASSERT_GE(t, last - 4e-16);
    last = t;
    worst = std::max(worst, std::fabs(atanQuarterPi(t) - x));
  }
  std::cout << "worst round trip " << worst << '\n';
  EXPECT_LE(worst, 1e-15);
}

}  // namespace
}  // namespace terrane

// Double-float against MPFR, for each operation: the worst relative error found in a search over random
// and over deliberately awkward operands stays below the published bound; and beside it stands what must fail: plain
// float, a misordered FastTwoSum, the sloppy sum.
#include "common/numerics/double_float.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "tests/numeric/double_float_search.h"

namespace terrane {
namespace {

using test::exact;
using test::HighPrecision;
using test::isNormalised;
using test::kSamples;
using test::Operands;

/// Relative error in units of u^2.
double errorUnits(const HighPrecision& error, const HighPrecision& reference) {
  if (reference == 0) return error == 0 ? 0.0 : std::numeric_limits<double>::infinity();
  return std::fabs(static_cast<double>(error / reference)) / kFloatUnitSquared;
}

struct Worst {
  double units = 0;
  void see(double error) { units = error > units ? error : units; }
};

void report(const char* name, const Worst& worst, double bound) {
  std::cout << name << ": worst " << worst.units << " u^2, bound " << bound << " u^2\n";
  EXPECT_LE(worst.units, bound) << name;
  EXPECT_GE(worst.units, 0.4 * std::min(bound, 5.0)) << "the search is too easy to prove anything";
}

TEST(DoubleFloat, SumsStayWithinTheirBounds) {
  Operands operands(311);
  Worst withFloat, alike, opposite, plain;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(-2, 3);
    DoubleFloat y = operands.pair(-26, 3);
    const float f = operands.single(-26, 3);
    const DoubleFloat sumFloat = add(x, f);
    ASSERT_TRUE(isNormalised(sumFloat));
    const HighPrecision referenceFloat = exact(x) + HighPrecision(f);
    withFloat.see(errorUnits(exact(sumFloat) - referenceFloat, referenceFloat));

    const DoubleFloat sum = add(x, y);
    ASSERT_TRUE(isNormalised(sum));
    const HighPrecision reference = exact(x) + exact(y);
    (x.hi * y.hi < 0 ? opposite : alike).see(errorUnits(exact(sum) - reference, reference));
    plain.see(errorUnits(HighPrecision(x.hi + y.hi) - reference, reference));
  }
  report("double-float + float", withFloat, kAddFloatBound);
  report("double-float + double-float, signs alike", alike, kAddBound);
  report("double-float + double-float, signs opposite", opposite, kAddBound);
  std::cout << "control, float: " << plain.units << " u^2\n";
  EXPECT_GT(plain.units, 1e6);
}

TEST(DoubleFloat, CancellationCostsNothingWhereTheSloppySumAndMisorderedSumLoseEverything) {
  Operands operands(312);
  Worst accurate, sloppy, misordered;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(0, 0);
    // The negative of x but for its last bits.
    DoubleFloat y{-x.hi, operands.pair(-25, -25).hi};
    if (operands.bits(1)) y.hi = std::nextafter(y.hi, 0.0f);
    y = twoSum(y.hi, y.lo);
    const HighPrecision reference = exact(x) + exact(y);
    const DoubleFloat sum = add(x, y);
    accurate.see(errorUnits(exact(sum) - reference, reference));
    // [JMP17] algorithm 5.
    const DoubleFloat s = twoSum(x.hi, y.hi);
    const float v = x.lo + y.lo;
    sloppy.see(errorUnits(exact(twoSum(s.hi, s.lo + v)) - reference, reference));
  }
  for (int i = 0; i < kSamples; ++i) {
    // A sum whose high words are added by FastTwoSum without regard to their order.
    const DoubleFloat x = operands.pair(-26, 0);
    DoubleFloat y = operands.pair(0, 3);
    if (x.hi * y.hi < 0) y = -y;
    const float hi = x.hi + y.hi;
    const float lo = (y.hi - (hi - x.hi)) + (x.lo + y.lo);
    const HighPrecision reference = exact(x) + exact(y);
    misordered.see(errorUnits(exact(twoSum(hi, lo)) - reference, reference));
  }
  std::cout << "opposite signs: accurate " << accurate.units << " u^2, sloppy " << sloppy.units
            << " u^2; misordered, same signs " << misordered.units << " u^2\n";
  EXPECT_LE(accurate.units, kAddBound);
  EXPECT_GT(sloppy.units, 1e6);
  EXPECT_GT(misordered.units, 1e6);
}

TEST(DoubleFloat, SubtractAndDemoteRoundsOnce) {
  Operands operands(313);
  double worst = 0, control = 0;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(0, 2);
    const DoubleFloat y = i % 2 ? operands.pair(0, 2) : twoSum(x.hi, operands.single(-40, -22));
    const HighPrecision reference = exact(x) - exact(y);
    const double error = errorUnits(HighPrecision(subtractAndDemote(x, y)) - reference, reference) * kFloatUnit;
    worst = std::max(worst, error);
    ASSERT_EQ(subtractAndDemote(x, y), subtract(x, y).hi);
    control = std::max(control, errorUnits(HighPrecision(x.hi - y.hi) - reference, reference) * kFloatUnit);
  }
  std::cout << "worst " << worst << " u, bound " << kSubtractAndDemoteBound << " u; control, float: " << control
            << " u\n";
  EXPECT_LE(worst, kSubtractAndDemoteBound);
  EXPECT_GT(worst, 0.9);
  EXPECT_GT(control, 1e6);
}

TEST(DoubleFloat, ProductsStayWithinTheirBounds) {
  Operands operands(314);
  Worst withFloat, full, plain, ends;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(0, 1);
    const DoubleFloat y = operands.pair(0, 1);
    const float f = operands.single(0, 1);
    ASSERT_TRUE(isNormalised(multiply(x, y)));
    ASSERT_TRUE(isNormalised(multiply(x, f)));
    const HighPrecision referenceFloat = exact(x) * HighPrecision(f);
    withFloat.see(errorUnits(exact(multiply(x, f)) - referenceFloat, referenceFloat));
    const HighPrecision reference = exact(x) * exact(y);
    full.see(errorUnits(exact(multiply(x, y)) - reference, reference));
    plain.see(errorUnits(HighPrecision(x.hi * y.hi) - reference, reference));
    // The ends of the range for which the bounds are stated.
    const DoubleFloat large = operands.pair(98, 99);
    const DoubleFloat small = operands.pair(-40, -39);
    const HighPrecision mixed = exact(large) * exact(small);
    ends.see(errorUnits(exact(multiply(large, small)) - mixed, mixed));
    const DoubleFloat half = operands.pair(-20, -20);
    const HighPrecision low = exact(half) * exact(operands.bits(1) ? half : -half);
    ends.see(errorUnits(HighPrecision(abs(HighPrecision(exact(multiply(half, half))))) - abs(low), low));
  }
  report("double-float * float", withFloat, kMultiplyFloatBound);
  report("double-float * double-float", full, kMultiplyBound);
  EXPECT_LE(ends.units, kMultiplyBound);
  EXPECT_GT(plain.units, 1e6);
}

TEST(DoubleFloat, QuotientsStayWithinTheirBounds) {
  Operands operands(315);
  Worst withFloat, full, plain;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(0, 1);
    const DoubleFloat y = operands.pair(0, 1);
    const float f = operands.single(0, 1);
    ASSERT_TRUE(isNormalised(divide(x, y)));
    // q y - x over x is the relative error of q.
    withFloat.see(errorUnits(exact(divide(x, f)) * HighPrecision(f) - exact(x), exact(x)));
    full.see(errorUnits(exact(divide(x, y)) * exact(y) - exact(x), exact(x)));
    plain.see(errorUnits(HighPrecision(x.hi / y.hi) * exact(y) - exact(x), exact(x)));
  }
  report("double-float / float", withFloat, kDivideFloatBound);
  report("double-float / double-float", full, kDivideBound);
  EXPECT_GT(plain.units, 1e6);
}

TEST(DoubleFloat, RootsStayWithinTheirBounds) {
  Operands operands(316);
  Worst root, inverse, plain;
  const auto see = [](Worst& worst, const HighPrecision& squareOverX) {
    // (1 + e)^2 - 1 = 2 e to the first order.
    worst.see(errorUnits(squareOverX - 1, HighPrecision(2)));
  };
  for (int i = 0; i < kSamples; ++i) {
    DoubleFloat x = i % 8 ? operands.pair(0, 1) : operands.pair(-40, 99);
    if (x.hi < 0) x = -x;
    const HighPrecision value = exact(x);
    const HighPrecision r = exact(squareRoot(x));
    see(root, r * r / value);
    const HighPrecision s = exact(inverseSquareRoot(x));
    see(inverse, s * s * value);
    const HighPrecision p = std::sqrt(x.hi);
    see(plain, p * p / value);
    ASSERT_TRUE(isNormalised(squareRoot(x)));
    ASSERT_TRUE(isNormalised(inverseSquareRoot(x)));
  }
  report("square root", root, kSquareRootBound);
  report("inverse square root", inverse, kInverseSquareRootBound);
  EXPECT_GT(plain.units, 1e6);
}

}  // namespace
}  // namespace terrane

// The transforms that double-float is built of lose nothing, by MPFR; plain float and a misordered
// FastTwoSum, beside them, do.
#include "common/numerics/double_float.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <utility>

#include "tests/numeric/double_float_search.h"

namespace terrane {
namespace {

using test::exact;
using test::HighPrecision;
using test::kSamples;
using test::Limits;
using test::Operands;

TEST(DoubleFloat, TwoSumIsExactInEitherOrder) {
  Operands operands(301);
  for (int i = 0; i < kSamples; ++i) {
    const float a = operands.single(-60, 60);
    const float b = operands.single(-60, 60);
    for (const DoubleFloat& s : {twoSum(a, b), twoSum(b, a)}) {
      ASSERT_EQ(s.hi, a + b);
      ASSERT_EQ(exact(s), HighPrecision(a) + HighPrecision(b));
    }
  }
}

TEST(DoubleFloat, FastTwoSumIsExactWhenOrderedAndWrongWhenNot) {
  Operands operands(302);
  int wrong = 0;
  for (int i = 0; i < kSamples; ++i) {
    float a = operands.single(-30, 30);
    float b = operands.single(-30, 30);
    if (std::fabs(a) < std::fabs(b)) std::swap(a, b);
    ASSERT_EQ(exact(fastTwoSum(a, b)), HighPrecision(a) + HighPrecision(b));
    // The control, written out, since the function itself refuses in debug builds.
    const float s = b + a;
    const float lo = a - (s - b);
    wrong += exact(DoubleFloat{s, lo}) != HighPrecision(a) + HighPrecision(b) ? 1 : 0;
  }
  std::cout << "misordered: " << wrong << " of " << kSamples << " wrong\n";
  EXPECT_GT(wrong, kSamples / 10);
  EXPECT_EQ(exact(fastTwoSum(0.0f, 3.0f)), 3);
}

TEST(DoubleFloatDeathTest, FastTwoSumRefusesItsOperandsTheWrongWayRound) {
#ifdef NDEBUG
  GTEST_SKIP() << "assertions are off in this build";
#else
  EXPECT_DEATH(fastTwoSum(1.0f, 2.0f), "");
#endif
}

TEST(DoubleFloat, TwoProdIsExactInBothForms) {
  Operands operands(303);
  int plainWrong = 0;
  for (int i = 0; i < kSamples; ++i) {
    const bool wide = i % 4 == 0;
    const float a = operands.single(wide ? 50 : -51, wide ? 125 : 63);
    const float b = operands.single(wide ? -100 : -50, wide ? 0 : 62);
    const HighPrecision product = HighPrecision(a) * HighPrecision(b);
    ASSERT_EQ(twoProd(a, b).hi, a * b);
    ASSERT_EQ(exact(twoProd(a, b)), product) << a << " " << b;
    ASSERT_EQ(exact(twoProd(b, a)), product) << a << " " << b;
    ASSERT_EQ(exact(twoProdFma(a, b)), product) << a << " " << b;
    plainWrong += HighPrecision(a * b) != product ? 1 : 0;
  }
  EXPECT_GT(plainWrong, kSamples / 2);
}

TEST(DoubleFloat, TwoProdOfLargeNumbersDoesNotOverflowInItsSplit) {
  for (const float a : {0x1.fffffep115f, 0x1.234566p116f, -0x1.fffffep120f, 0x1.fffffep126f}) {
    for (const float b : {0x1.000002p0f, 0x1.fffffep-1f, 0x1.234566p-20f, -0x1.8p-60f}) {
      const DoubleFloat p = twoProd(a, b);
      EXPECT_EQ(exact(p), HighPrecision(a) * HighPrecision(b)) << a << " " << b;
      EXPECT_EQ(exact(twoProdFma(a, b)), HighPrecision(a) * HighPrecision(b));
    }
    // The control: Veltkamp's split as it is usually written.
    const volatile float c = 4097.0f * a;
    EXPECT_FALSE(std::isfinite(c - (c - a))) << a;
  }
}

TEST(DoubleFloat, TwoProdLosesItsErrorTermOnlyBelowTheStatedFloor) {
  Operands operands(304);
  for (int i = 0; i < 20000; ++i) {
    const float a = operands.single(-70, -40);
    const float b = operands.single(-70, -32);
    const DoubleFloat p = twoProd(a, b);
    const HighPrecision product = HighPrecision(a) * HighPrecision(b);
    if (abs(product) >= HighPrecision(0x1p-102)) {
      ASSERT_EQ(exact(p), product);
    }
    // Below, never worse than a few of the smallest denormals.
    ASSERT_LE(abs(HighPrecision(exact(p) - product)), HighPrecision(4 * Limits::denorm_min()));
  }
  const DoubleFloat lost = twoProd(0x1.000002p-60f, 0x1.000002p-60f);
  EXPECT_NE(exact(lost), HighPrecision(0x1.000002p-60) * HighPrecision(0x1.000002p-60)) << "the floor is real";
}

}  // namespace
}  // namespace terrane

// What double_float.h promises for values that are no ordinary numbers, of every function: NaN, infinities, overflow,
// zeros with their sign, denormals. The control: the bare algorithms keep none of it.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "common/numerics/double_float.h"
#include "tests/numeric/double_float_search.h"
#include "tests/support/double_float_conformance.h"

namespace terrane {
namespace {

using test::exact;
using test::HighPrecision;
using test::Limits;
using test::OperandPair;
using test::Operands;
using test::PairOperation;

constexpr float kInfinity = Limits::infinity();

/// What a float does, by the operation's exact form: in double it is exact or infinite as the float is to be.
float plainResult(const PairOperation& operation, float x, float y) {
  const std::string name = operation.name;
  if (name.starts_with("add")) return x + y;
  if (name.starts_with("subtract")) return x - y;
  if (name.starts_with("multiply")) return x * y;
  if (name.starts_with("divide")) return x / y;
  return name.starts_with("square") ? std::sqrt(x) : 1.0f / std::sqrt(x);
}

bool sameBits(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

TEST(DoubleFloatSpecialValues, EveryFunctionGivesNaNInfinitiesZerosAndOverflowAsFloatDoes) {
  const std::array<float, 16> values{0.0f,
                                     -0.0f,
                                     1.0f,
                                     -2.0f,
                                     kInfinity,
                                     -kInfinity,
                                     Limits::quiet_NaN(),
                                     Limits::max(),
                                     -Limits::max(),
                                     Limits::min(),
                                     Limits::denorm_min(),
                                     -Limits::denorm_min(),
                                     0x1p-75f,
                                     0x1.8p104f,
                                     -0x1.8p104f,
                                     0x1p120f};
  std::size_t bareWrong = 0;
  for (const PairOperation& operation : test::pairOperations()) {
    for (const float a : values) {
      for (const float b : values) {
        const DoubleFloat x(a, 0), y(b, 0);
        const float plain = plainResult(operation, a, b);
        const DoubleFloat result = operation.settled(x, y);
        const std::string what = std::string(operation.name) + " " + std::to_string(a) + " " + std::to_string(b);
        if (std::isfinite(plain) && plain != 0) {
          // There may be an error term, which never moves hi; but 1/sqrt of floats is rounded twice and is put right.
          const bool roundedTwice = std::string_view(operation.name) == "inverseSquareRootPair";
          EXPECT_TRUE(sameBits(result.hi, plain) ||
                      (roundedTwice && std::fabs(result.hi - plain) <= 3 * 0x1p-24f * plain))
              << what << ": " << result.hi;
          EXPECT_TRUE(std::isfinite(result.lo)) << what;
        } else {
          EXPECT_TRUE(sameBits(result.hi, plain)) << what << ": " << result.hi;
          EXPECT_EQ(result.lo, 0.0f) << what;
        }
        const DoubleFloat bare = operation.bare(x, y);
        bareWrong += sameBits(bare.hi, plain) && (bare.lo == 0 || std::isfinite(plain)) ? 0u : 1u;
      }
    }
  }
  std::cout << "control, bare: " << bareWrong << " results are not as float's\n";
  EXPECT_GT(bareWrong, 100u);
}

TEST(DoubleFloatSpecialValues, TheWordByWordDifferenceTheConversionsAndTheOrderKeepThemToo) {
  const std::array<float, 8> values{0.0f, -0.0f, 1.0f, -2.0f, kInfinity, -kInfinity, Limits::quiet_NaN(), 0x1p-149f};
  for (const float a : values) {
    const DoubleFloat converted = fromDouble(static_cast<double>(a));
    EXPECT_TRUE(sameBits(converted.hi, a));
    EXPECT_EQ(converted.lo, 0.0f);
    EXPECT_TRUE(sameBits(static_cast<float>(toDouble(converted)), a));
    EXPECT_TRUE(sameBits((-converted).hi, -a));
    for (const float b : values) {
      EXPECT_TRUE(sameBits(subtractWordsAndDemote(DoubleFloat(a, 0), DoubleFloat(b, 0)), a - b)) << a << " " << b;
      EXPECT_EQ(compare(DoubleFloat(a, 0), DoubleFloat(b, 0)), a <=> b) << a << " " << b;
    }
  }
  EXPECT_EQ(fromDouble(1e300).hi, kInfinity);
  EXPECT_EQ(fromDouble(1e300).lo, 0.0f);
}

TEST(DoubleFloatSpecialValues, BareAlgorithmsNeverTurnWhatIsNotFiniteIntoAFiniteNumber) {
  const auto expectSpoilt = [](const DoubleFloat& result, const char* what) {
    EXPECT_FALSE(std::isfinite(result.hi) && std::isfinite(result.lo)) << what;
  };
  for (const float bad : {kInfinity, -kInfinity, Limits::quiet_NaN()}) {
    for (const PairOperation& operation : test::pairOperations()) {
      expectSpoilt(operation.bare(DoubleFloat(bad, 0), DoubleFloat(2, 0)), operation.name);
      if (operation.operands != test::OperandKind::Positive)
        expectSpoilt(operation.bare(DoubleFloat(2, 0), DoubleFloat(bad, 0)), operation.name);
    }
    for (const float other : {3.0f, 0.0f}) {
      expectSpoilt(twoSum(bad, other), "twoSum");
      expectSpoilt(twoSum(other, bad), "twoSum");
      expectSpoilt(twoProd(bad, other), "twoProd");
      expectSpoilt(twoProdFma(other, bad), "twoProdFma");
    }
    expectSpoilt(fastTwoSum(bad, 1.0f), "fastTwoSum");
  }
  expectSpoilt(twoSum(Limits::max(), Limits::max()), "overflow");
  expectSpoilt(twoProd(Limits::max(), 2.0f), "overflow");
  EXPECT_TRUE(sameBits(twoSum(-0.0f, -0.0f).hi, -0.0f));
  EXPECT_TRUE(sameBits(twoSum(-0.0f, -0.0f).lo, 0.0f));
  EXPECT_TRUE(sameBits(twoProd(-0.0f, 1.0f).hi, -0.0f));
}

TEST(DoubleFloatSpecialValues, SumsOfDenormalsAreExact) {
  const float d = Limits::denorm_min();
  EXPECT_EQ(add(DoubleFloat{d, 0}, DoubleFloat{d, 0}).hi, 2 * d);
  EXPECT_EQ(exact(add(DoubleFloat{1.0f, d}, DoubleFloat{-1.0f, 0})), HighPrecision(d));
  EXPECT_EQ(subtractAndDemote(DoubleFloat{1.0f, d}, DoubleFloat{1.0f, 0}), d);
  Operands operands(341);
  for (int i = 0; i < 20000; ++i) {
    const DoubleFloat x(operands.single(-149, -120), 0), y(operands.single(-149, -120), 0);
    ASSERT_EQ(exact(add(x, y)), exact(x) + exact(y));
    ASSERT_EQ(exact(twoSum(x.hi, y.hi)), exact(x) + exact(y));
  }
}

TEST(DoubleFloatSpecialValues, AmongDenormalsProductsQuotientsAndRootsDecayToAFloatsAccuracyAndNoFurther) {
  Operands operands(342);
  double worst = 0;
  std::size_t bareWorse = 0;
  for (int i = 0; i < 200000; ++i) {
    const PairOperation& operation = test::pairOperations()[4 + static_cast<std::size_t>(i) % 6];
    OperandPair pair{operands.pair(-149, -60), operands.pair(i % 2 != 0 ? -149 : -60, i % 2 != 0 ? -60 : 30)};
    if (operation.yIsFloat) pair.y.lo = 0;
    if (operation.operands == test::OperandKind::Positive && pair.x.hi < 0) pair.x = -pair.x;
    const HighPrecision reference = operation.exact(exact(pair.x), exact(pair.y));
    if (!std::isfinite(static_cast<float>(reference))) continue;
    const HighPrecision floor = 2 * HighPrecision(Limits::denorm_min());
    const auto share = [&](const DoubleFloat& result) {
      const HighPrecision error = abs(HighPrecision(exact(result) - reference));
      return static_cast<double>(
          HighPrecision(error / std::max(HighPrecision(abs(reference) * (8 * kFloatUnit)), floor)));
    };
    worst = std::max(worst, share(operation.settled(pair.x, pair.y)));
    bareWorse += share(operation.bare(pair.x, pair.y)) > 1 ? 1u : 0u;
  }
  std::cout << "worst error " << worst << " of a float's; control, bare: " << bareWorse << " beyond that\n";
  EXPECT_LE(worst, 1.0);
  EXPECT_GT(bareWorse, 0u);
}

}  // namespace
}  // namespace terrane

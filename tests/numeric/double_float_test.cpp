// Double-float against MPFR: every implementation that C++ has keeps the proven bounds in a search that comes as near
// to them as is known to be possible; and beside it stands what must fail: plain float, a misordered FastTwoSum, the
// sloppy sum, the word-by-word difference where too much cancels.
#include "common/numerics/double_float.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "tests/numeric/double_float_search.h"
#include "tests/support/double_float_conformance.h"

namespace terrane {
namespace {

using test::exact;
using test::HighPrecision;
using test::isNormalised;
using test::kSamples;
using test::kSearchSamples;
using test::OperandPair;
using test::Operands;
using test::PairOperation;

/// Relative error in units of u^2.
double errorUnits(const HighPrecision& error, const HighPrecision& reference) {
  if (reference == 0) return error == 0 ? 0.0 : std::numeric_limits<double>::infinity();
  return std::fabs(static_cast<double>(HighPrecision(error / reference))) / kFloatUnitSquared;
}

struct Worst {
  double units = 0;
  void see(double error) { units = error > units ? error : units; }
};

TEST(DoubleFloatConformance, WorstErrorsFoundBySearchAreUnderTheProvenBoundsAndNearThem) {
  constexpr std::uint64_t kSeed = 311;
  std::cout << "seed " << kSeed << '\n';
  const test::Evaluate normalised = [](const PairOperation& operation, std::span<const OperandPair> operands) {
    auto results = test::bareOnCpu()(operation, operands);
    for (const DoubleFloat& result : results) EXPECT_TRUE(isNormalised(result)) << operation.name;
    return results;
  };
  for (const PairOperation& operation : test::pairOperations()) {
    const test::WorstFound worst = test::searchWorst(operation, normalised, kSeed, kSearchSamples);
    std::cout << operation.title << " (" << operation.source << "): worst " << worst.units << ", bound "
              << operation.bound << (operation.unit == kFloatUnit ? " u" : " u^2") << ", at x = " << std::hexfloat
              << worst.at.x.hi << " + " << worst.at.x.lo << ", y = " << worst.at.y.hi << " + " << worst.at.y.lo
              << std::defaultfloat << '\n';
    EXPECT_LE(worst.units, operation.bound) << operation.name;
    if (!test::kSearchIsFull) continue;
    EXPECT_GE(worst.units, operation.expected) << operation.name << ": the search is too easy to prove anything";
  }
}

TEST(DoubleFloatConformance, ThePublicFunctionsAndTheLanesOfVectorsGiveTheSameBits) {
  const test::Evaluate bare = test::bareOnCpu();
  for (const auto& other : {test::settledOnCpu(), test::bareOnCpuInThrees()}) {
    const test::Evaluate both = [&](const PairOperation& operation, std::span<const OperandPair> operands) {
      auto expected = bare(operation, operands), results = other(operation, operands);
      for (std::size_t i = 0; i < results.size(); ++i)
        EXPECT_TRUE(results[i].hi == expected[i].hi && results[i].lo == expected[i].lo) << operation.name;
      return results;
    };
    for (const PairOperation& operation : test::pairOperations())
      EXPECT_LE(test::searchWorst(operation, both, 317, kSamples / 10).units, operation.bound);
  }
}

TEST(DoubleFloat, PlainFloatBreaksEveryBound) {
  for (const PairOperation& operation : test::pairOperations()) {
    if (operation.unit == kFloatUnit && operation.operands != test::OperandKind::Difference) continue;
    // The high words alone.
    const test::Evaluate plain = [](const PairOperation& one, std::span<const OperandPair> operands) {
      std::vector<DoubleFloat> results;
      for (const OperandPair& pair : operands)
        results.push_back(one.bare(DoubleFloat(pair.x.hi, 0), DoubleFloat(pair.y.hi, 0)));
      return results;
    };
    const double worst = test::searchWorst(operation, plain, 312, 3000).units;
    EXPECT_GT(worst, 1e6) << operation.name;
  }
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

TEST(DoubleFloat, TheWordByWordDifferenceKeepsItsBoundAndLosesEverythingOnlyBelowFloatsOwnSpacing) {
  Operands operands(313);
  double nearestToBound = 0, worstFar = 0, worstClose = 0;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(0, 2);
    const DoubleFloat y =
        i % 2 ? operands.pair(0, 2) : add(x, operands.single(-44, -2));  // from far apart to the last bits
    const HighPrecision reference = exact(x) - exact(y);
    if (reference == 0) continue;
    const double error = errorUnits(HighPrecision(subtractWordsAndDemote(x, y)) - reference, reference) * kFloatUnit;
    const double closeness = std::fabs(static_cast<double>(HighPrecision(reference / (abs(exact(x)) + abs(exact(y))))));
    ASSERT_LE(error, subtractWordsBound(closeness)) << closeness;
    nearestToBound = std::max(nearestToBound, error / subtractWordsBound(closeness));
    if (closeness > 0x1p-23) worstFar = std::max(worstFar, error);
    if (closeness < 0x1p-30) worstClose = std::max(worstClose, error);
    ASSERT_EQ(subtractAndDemote(x, y), subtract(x, y).hi);
  }
  std::cout << "as near as " << nearestToBound << " of the bound; operands further apart than 2^-23: " << worstFar
            << " u, closer than 2^-30: " << worstClose << " u\n";
  EXPECT_GT(nearestToBound, 0.5) << "a bound that nothing comes near says little";
  EXPECT_LE(worstFar, 2.1);
  EXPECT_GT(worstClose, 1e3) << "the control: there the eighteen operations are worth their time";
}

TEST(DoubleFloat, ProductsKeepTheirBoundAtTheEndsOfTheStatedRange) {
  Operands operands(314);
  Worst ends;
  for (int i = 0; i < kSamples / 4; ++i) {
    const DoubleFloat large = operands.pair(98, 99), small = operands.pair(-40, -39), half = operands.pair(-20, -20);
    const HighPrecision mixed = exact(large) * exact(small), low = exact(half) * exact(half);
    ends.see(errorUnits(exact(multiply(large, small)) - mixed, mixed));
    ends.see(errorUnits(exact(multiply(half, half)) - low, low));
  }
  EXPECT_LE(ends.units, kMultiplyBound);
  EXPECT_GT(ends.units, 3.0);
}

TEST(DoubleFloat, RootsKeepTheirBoundsOverTheWholeStatedRange) {
  Operands operands(316);
  Worst root, inverse;
  for (int i = 0; i < kSamples / 4; ++i) {
    DoubleFloat x = operands.pair(-40, 99);
    if (x.hi < 0) x = -x;
    const HighPrecision r = sqrt(exact(x)), s = 1 / r;
    root.see(errorUnits(exact(squareRoot(x)) - r, r));
    inverse.see(errorUnits(exact(inverseSquareRoot(x)) - s, s));
  }
  EXPECT_LE(root.units, kSquareRootBound);
  EXPECT_LE(inverse.units, kInverseSquareRootBound);
}

}  // namespace
}  // namespace terrane

// Double-float against 113-bit arithmetic, for each operation: the worst relative error found in a search over random
// and over deliberately awkward operands stays below the published bound; and beside it stands what must fail: plain
// float, a misordered FastTwoSum, the sloppy sum.
#include "common/numerics/double_float.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>

namespace terrane {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;
using Limits = std::numeric_limits<float>;

constexpr int kSamples = 100000;

Quad exact(const DoubleFloat& x) { return Quad(x.hi) + Quad(x.lo); }

class Operands {
 public:
  explicit Operands(std::uint64_t seed) : engine_(seed) { std::cout << "seed " << seed << '\n'; }

  std::uint64_t bits(int count) { return engine_() >> (64 - count); }

  /// A float with exponent in [low, high]; its mantissa is often close to 1 or to 2, where relative errors peak.
  float single(int low, int high) {
    const std::uint64_t kind = bits(2);
    std::uint64_t mantissa = bits(23);
    if (kind == 0) mantissa = bits(3);
    if (kind == 1) mantissa = 0x7fffff - bits(3);
    const int exponent = low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
    const float magnitude = std::ldexp(1.0f + std::ldexp(static_cast<float>(mantissa), -23), exponent);
    return bits(1) ? -magnitude : magnitude;
  }

  /// A normalised pair; its low word is often as large as it may be, sometimes tiny or 0.
  DoubleFloat pair(int low, int high) {
    const float hi = single(low, high);
    const int exponent = std::ilogb(hi) - 24;
    const std::uint64_t kind = bits(3);
    float lo = single(exponent - 1, exponent - 1);
    if (kind == 0) lo = single(exponent - 20, exponent - 1);
    if (kind == 1) lo = 0.0f;
    if (kind == 2) lo = std::copysign(std::ldexp(1.0f, exponent) * (1.0f - 0x1p-24f), lo);
    return twoSum(hi, lo);
  }

 private:
  std::mt19937_64 engine_;
};

/// Relative error in units of u^2.
double errorUnits(const Quad& error, const Quad& reference) {
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

bool isNormalised(const DoubleFloat& x) { return x.hi + x.lo == x.hi; }

// ---- error-free transforms ----

TEST(DoubleFloat, TwoSumIsExactInEitherOrder) {
  Operands operands(301);
  for (int i = 0; i < kSamples; ++i) {
    const float a = operands.single(-60, 60);
    const float b = operands.single(-60, 60);
    for (const DoubleFloat& s : {twoSum(a, b), twoSum(b, a)}) {
      ASSERT_EQ(s.hi, a + b);
      ASSERT_EQ(exact(s), Quad(a) + Quad(b));
    }
  }
  static_assert(twoSum(1e8f, 1.0f).hi + twoSum(1e8f, 1.0f).lo == 1e8f && twoSum(1e8f, 1.0f).lo == 1.0f);
}

TEST(DoubleFloat, FastTwoSumIsExactWhenOrderedAndWrongWhenNot) {
  Operands operands(302);
  int wrong = 0;
  for (int i = 0; i < kSamples; ++i) {
    float a = operands.single(-30, 30);
    float b = operands.single(-30, 30);
    if (std::fabs(a) < std::fabs(b)) std::swap(a, b);
    ASSERT_EQ(exact(fastTwoSum(a, b)), Quad(a) + Quad(b));
    // The control, written out, since the function itself refuses in debug builds.
    const float s = b + a;
    const float lo = a - (s - b);
    wrong += exact(DoubleFloat{s, lo}) != Quad(a) + Quad(b) ? 1 : 0;
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
    const Quad product = Quad(a) * Quad(b);
    ASSERT_EQ(twoProd(a, b).hi, a * b);
    ASSERT_EQ(exact(twoProd(a, b)), product) << a << " " << b;
    ASSERT_EQ(exact(twoProd(b, a)), product) << a << " " << b;
    ASSERT_EQ(exact(twoProdFma(a, b)), product) << a << " " << b;
    plainWrong += Quad(a * b) != product ? 1 : 0;
  }
  EXPECT_GT(plainWrong, kSamples / 2);
}

TEST(DoubleFloat, TwoProdOfLargeNumbersDoesNotOverflowInItsSplit) {
  for (const float a : {0x1.fffffep115f, 0x1.234566p116f, -0x1.fffffep120f, 0x1.fffffep126f}) {
    for (const float b : {0x1.000002p0f, 0x1.fffffep-1f, 0x1.234566p-20f, -0x1.8p-60f}) {
      const DoubleFloat p = twoProd(a, b);
      EXPECT_EQ(exact(p), Quad(a) * Quad(b)) << a << " " << b;
      EXPECT_EQ(exact(twoProdFma(a, b)), Quad(a) * Quad(b));
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
    const Quad product = Quad(a) * Quad(b);
    if (abs(product) >= Quad(0x1p-102)) {
      ASSERT_EQ(exact(p), product);
    }
    // Below, never worse than a few of the smallest denormals.
    ASSERT_LE(abs(Quad(exact(p) - product)), Quad(4 * Limits::denorm_min()));
  }
  const DoubleFloat lost = twoProd(0x1.000002p-60f, 0x1.000002p-60f);
  EXPECT_NE(exact(lost), Quad(0x1.000002p-60) * Quad(0x1.000002p-60)) << "the floor is real";
}

// ---- operations within their bounds ----

TEST(DoubleFloat, SumsStayWithinTheirBounds) {
  Operands operands(311);
  Worst withFloat, alike, opposite, plain;
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(-2, 3);
    DoubleFloat y = operands.pair(-26, 3);
    const float f = operands.single(-26, 3);
    const DoubleFloat sumFloat = add(x, f);
    ASSERT_TRUE(isNormalised(sumFloat));
    const Quad referenceFloat = exact(x) + Quad(f);
    withFloat.see(errorUnits(exact(sumFloat) - referenceFloat, referenceFloat));

    const DoubleFloat sum = add(x, y);
    ASSERT_TRUE(isNormalised(sum));
    const Quad reference = exact(x) + exact(y);
    (x.hi * y.hi < 0 ? opposite : alike).see(errorUnits(exact(sum) - reference, reference));
    plain.see(errorUnits(Quad(x.hi + y.hi) - reference, reference));
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
    const Quad reference = exact(x) + exact(y);
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
    const Quad reference = exact(x) + exact(y);
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
    const Quad reference = exact(x) - exact(y);
    const double error = errorUnits(Quad(subtractAndDemote(x, y)) - reference, reference) * kFloatUnit;
    worst = std::max(worst, error);
    ASSERT_EQ(subtractAndDemote(x, y), subtract(x, y).hi);
    control = std::max(control, errorUnits(Quad(x.hi - y.hi) - reference, reference) * kFloatUnit);
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
    const Quad referenceFloat = exact(x) * Quad(f);
    withFloat.see(errorUnits(exact(multiply(x, f)) - referenceFloat, referenceFloat));
    const Quad reference = exact(x) * exact(y);
    full.see(errorUnits(exact(multiply(x, y)) - reference, reference));
    plain.see(errorUnits(Quad(x.hi * y.hi) - reference, reference));
    // The ends of the range for which the bounds are stated.
    const DoubleFloat large = operands.pair(98, 99);
    const DoubleFloat small = operands.pair(-40, -39);
    const Quad mixed = exact(large) * exact(small);
    ends.see(errorUnits(exact(multiply(large, small)) - mixed, mixed));
    const DoubleFloat half = operands.pair(-20, -20);
    const Quad low = exact(half) * exact(operands.bits(1) ? half : -half);
    ends.see(errorUnits(Quad(abs(Quad(exact(multiply(half, half))))) - abs(low), low));
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
    withFloat.see(errorUnits(exact(divide(x, f)) * Quad(f) - exact(x), exact(x)));
    full.see(errorUnits(exact(divide(x, y)) * exact(y) - exact(x), exact(x)));
    plain.see(errorUnits(Quad(x.hi / y.hi) * exact(y) - exact(x), exact(x)));
  }
  report("double-float / float", withFloat, kDivideFloatBound);
  report("double-float / double-float", full, kDivideBound);
  EXPECT_GT(plain.units, 1e6);
}

TEST(DoubleFloat, RootsStayWithinTheirBounds) {
  Operands operands(316);
  Worst root, inverse, plain;
  const auto see = [](Worst& worst, const Quad& squareOverX) {
    // (1 + e)^2 - 1 = 2 e to the first order.
    worst.see(errorUnits(squareOverX - 1, Quad(2)));
  };
  for (int i = 0; i < kSamples; ++i) {
    DoubleFloat x = i % 8 ? operands.pair(0, 1) : operands.pair(-40, 99);
    if (x.hi < 0) x = -x;
    const Quad value = exact(x);
    const Quad r = exact(squareRoot(x));
    see(root, r * r / value);
    const Quad s = exact(inverseSquareRoot(x));
    see(inverse, s * s * value);
    const Quad p = std::sqrt(x.hi);
    see(plain, p * p / value);
    ASSERT_TRUE(isNormalised(squareRoot(x)));
    ASSERT_TRUE(isNormalised(inverseSquareRoot(x)));
  }
  report("square root", root, kSquareRootBound);
  report("inverse square root", inverse, kInverseSquareRootBound);
  EXPECT_GT(plain.units, 1e6);
}

// ---- conversions, order, special values ----

TEST(DoubleFloat, ADoubleAtOneAstronomicalUnitComesBackWithinAQuarterMillimetre) {
  Operands operands(321);
  constexpr double kAstronomicalUnitMeters = 149597870700.0;
  double worst = 0, control = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double d = kAstronomicalUnitMeters * (0.5 + static_cast<double>(operands.bits(53)) * 0x1p-54);
    const DoubleFloat x = fromDouble(d);
    ASSERT_TRUE(isNormalised(x));
    worst = std::max(worst, std::fabs(toDouble(x) - d));
    control = std::max(control, std::fabs(static_cast<double>(static_cast<float>(d)) - d));
    ASSERT_LE(std::fabs(toDouble(x) - d), kFromDoubleBound * kFloatUnitSquared * d);
  }
  std::cout << "worst " << worst << " m; control, float: " << control << " m\n";
  EXPECT_LE(worst, 2.5e-4);
  EXPECT_GT(control, 1000.0);
}

TEST(DoubleFloat, LatticePositionsAreExact) {
  // Tile origins are multiples of a power of two with at most 45 bits: nothing is lost.
  Operands operands(322);
  for (int i = 0; i < kSamples; ++i) {
    const double origin = std::ldexp(static_cast<double>(operands.bits(45)), -23) * (operands.bits(1) ? 1 : -1);
    ASSERT_EQ(toDouble(fromDouble(origin)), origin);
  }
}

TEST(DoubleFloat, ComparisonIsByValue) {
  Operands operands(323);
  for (int i = 0; i < kSamples; ++i) {
    const DoubleFloat x = operands.pair(-1, 1);
    const DoubleFloat y = i % 3 == 0 ? x : i % 3 == 1 ? twoSum(x.hi, operands.single(-40, -26)) : operands.pair(-1, 1);
    const Quad difference = exact(x) - exact(y);
    const std::partial_ordering order = compare(x, y);
    ASSERT_EQ(order == std::partial_ordering::less, difference < 0);
    ASSERT_EQ(order == std::partial_ordering::greater, difference > 0);
    ASSERT_EQ(order == std::partial_ordering::equivalent, difference == 0);
  }
  EXPECT_EQ(compare(fromDouble(0.0), fromDouble(-0.0)), std::partial_ordering::equivalent);
  EXPECT_EQ(compare(DoubleFloat{Limits::quiet_NaN(), 0}, fromDouble(1)), std::partial_ordering::unordered);
}

void expectAsFloat(const DoubleFloat& result, float reference, const std::string& what) {
  if (std::isnan(reference)) {
    EXPECT_TRUE(std::isnan(result.hi)) << what;
  } else {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(result.hi), std::bit_cast<std::uint32_t>(reference)) << what;
  }
  EXPECT_EQ(result.lo, 0.0f) << what;
}

TEST(DoubleFloat, ZerosInfinitiesAndNaNBehaveAsFloatsDo) {
  constexpr float kInfinity = Limits::infinity();
  const std::array<float, 8> values{0.0f, -0.0f, 1.0f, -2.0f, kInfinity, -kInfinity, Limits::quiet_NaN(), 0.5f};
  for (const float a : values) {
    const DoubleFloat x{a, 0.0f};
    const std::string one = std::to_string(a);
    expectAsFloat(squareRoot(DoubleFloat{a * a == 1.0f || a == 0 || !std::isfinite(a) ? a : 4.0f, 0.0f}),
                  std::sqrt(a * a == 1.0f || a == 0 || !std::isfinite(a) ? a : 4.0f), "sqrt " + one);
    if (a == 0 || !std::isfinite(a) || a == 1) {
      expectAsFloat(inverseSquareRoot(x), 1.0f / std::sqrt(a), "rsqrt " + one);
    }
    expectAsFloat(fromDouble(static_cast<double>(a)), a, "from double " + one);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(toDouble(fromDouble(static_cast<double>(a)))),
              std::bit_cast<std::uint64_t>(static_cast<double>(a)));
    for (const float b : values) {
      const DoubleFloat y{b, 0.0f};
      const std::string both = one + " " + std::to_string(b);
      expectAsFloat(add(x, y), a + b, "add " + both);
      expectAsFloat(add(x, b), a + b, "add float " + both);
      expectAsFloat(subtract(x, y), a - b, "subtract " + both);
      expectAsFloat(multiply(x, y), a * b, "multiply " + both);
      expectAsFloat(multiply(x, b), a * b, "multiply float " + both);
      expectAsFloat(divide(x, y), a / b, "divide " + both);
      expectAsFloat(divide(x, b), a / b, "divide float " + both);
      const float demoted = subtractAndDemote(x, y);
      EXPECT_TRUE(std::isnan(a - b) ? std::isnan(demoted)
                                    : std::bit_cast<std::uint32_t>(demoted) == std::bit_cast<std::uint32_t>(a - b))
          << "demote " << both;
    }
  }
  expectAsFloat(fromDouble(1e300), kInfinity, "beyond float");
  expectAsFloat(multiply(fromDouble(1e30), fromDouble(1e30)), kInfinity, "overflow");
  expectAsFloat(add(DoubleFloat{Limits::max(), 0}, DoubleFloat{Limits::max(), 0}), kInfinity, "overflow");
  expectAsFloat(multiply(fromDouble(-1e-30), fromDouble(1e-30)), -0.0f, "underflow");
}

TEST(DoubleFloat, DenormalsAddExactly) {
  const float d = Limits::denorm_min();
  EXPECT_EQ(add(DoubleFloat{d, 0}, DoubleFloat{d, 0}).hi, 2 * d);
  EXPECT_EQ(exact(add(DoubleFloat{1.0f, d}, DoubleFloat{-1.0f, 0})), Quad(d));
  EXPECT_EQ(subtractAndDemote(DoubleFloat{1.0f, d}, DoubleFloat{1.0f, 0}), d);
}

// ---- what it is for ----

TEST(DoubleFloat, ACameraMovedByAMillimetreMovesEveryVertexByAMillimetre) {
  // Vertices within 8 m of a camera at the Earth's radius; the camera steps 1 mm along x. What the vertex shader does:
  // origin plus offset, minus camera, demoted to float.
  Operands operands(331);
  constexpr double kRadiusMeters = 6371000.0;
  constexpr double kMillimetre = 1e-3;
  double worst = 0, control = 0;
  for (int i = 0; i < 20000; ++i) {
    const double angle = static_cast<double>(operands.bits(53)) * 0x1p-53;
    const double camera = kRadiusMeters * angle;
    const double vertex =
        std::floor((camera + 16.0 * (static_cast<double>(operands.bits(53)) * 0x1p-53 - 0.5)) * 1024.0) / 1024.0;
    const DoubleFloat position = fromDouble(vertex);
    const float before = subtractAndDemote(position, fromDouble(camera));
    const float after = subtractAndDemote(position, fromDouble(camera + kMillimetre));
    worst = std::max(worst, std::fabs(static_cast<double>(before) - static_cast<double>(after) - kMillimetre));
    const float floatBefore = static_cast<float>(vertex) - static_cast<float>(camera);
    const float floatAfter = static_cast<float>(vertex) - static_cast<float>(camera + kMillimetre);
    control =
        std::max(control, std::fabs(static_cast<double>(floatBefore) - static_cast<double>(floatAfter) - kMillimetre));
  }
  std::cout << "off by at most " << worst << " m; control, float: " << control << " m\n";
  // A float of 50 m has a spacing of 3.8 micrometres: half of that, twice, is the float's own; the rest must be
  // nothing.
  EXPECT_LE(worst, 1e-6);
  EXPECT_GT(control, 0.1);
}

}  // namespace
}  // namespace terrane

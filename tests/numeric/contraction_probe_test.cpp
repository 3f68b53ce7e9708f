// What determinism rests on, asked of the compiler that built this program: a b + c is rounded twice, expressions are
// evaluated in the order they are written, and denormals, -0 and NaN are what IEEE 754 says. No macro tells of
// contraction, so a probe does: compiled for a CPU that has fused multiply-add, where it would happen if it may.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "common/numerics/strict_math.h"

#if defined(__x86_64__)
#define TERRANE_FMA_TARGET __attribute__((target("fma")))
#else
#define TERRANE_FMA_TARGET
#endif

namespace terrane {
namespace {

bool cpuHasFma() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("fma") != 0;
#else
  return true;
#endif
}

// The flags of the build, on a target with fused multiply-add.
TERRANE_FMA_TARGET __attribute__((noinline)) double productPlus(double a, double b, double c) { return a * b + c; }
TERRANE_FMA_TARGET __attribute__((noinline)) float productPlus(float a, float b, float c) { return a * b + c; }
TERRANE_FMA_TARGET __attribute__((noinline)) double cross(double a, double b, double c, double d) {
  return a * b - c * d;
}

// The control: the same expression where contraction is allowed.
#if defined(__clang__)
TERRANE_FMA_TARGET __attribute__((noinline)) double contracted(double a, double b, double c) {
#pragma clang fp contract(fast)
  return a * b + c;
}
#else
TERRANE_FMA_TARGET __attribute__((noinline, optimize("O2", "fp-contract=fast"))) double contracted(double a, double b,
                                                                                                   double c) {
  return a * b + c;
}
#endif

struct Pairs {
  float high[3], low[3];
};

// Straight-line code, three splits side by side: what GCC 12.2's basic-block vectoriser gets wrong.
__attribute__((noinline)) Pairs split(double x, double y, double z) {
  Pairs pairs{};
  pairs.high[0] = static_cast<float>(x);
  pairs.high[1] = static_cast<float>(y);
  pairs.high[2] = static_cast<float>(z);
  pairs.low[0] = static_cast<float>(x - static_cast<double>(pairs.high[0]));
  pairs.low[1] = static_cast<float>(y - static_cast<double>(pairs.high[1]));
  pairs.low[2] = static_cast<float>(z - static_cast<double>(pairs.high[2]));
  return pairs;
}

#if !defined(__clang__)
// The control: the same code with that vectoriser on.
__attribute__((noinline, optimize("O3", "tree-slp-vectorize"))) Pairs splitVectorised(double x, double y, double z) {
  Pairs pairs{};
  pairs.high[0] = static_cast<float>(x);
  pairs.high[1] = static_cast<float>(y);
  pairs.high[2] = static_cast<float>(z);
  pairs.low[0] = static_cast<float>(x - static_cast<double>(pairs.high[0]));
  pairs.low[1] = static_cast<float>(y - static_cast<double>(pairs.high[1]));
  pairs.low[2] = static_cast<float>(z - static_cast<double>(pairs.high[2]));
  return pairs;
}
#endif

TEST(StrictMath, LowWordsSurvive) {
  const volatile double x = 1.0 + 0x1p-30, y = 3.0 + 0x1p-29, z = 5.0 + 0x1p-28;
  const Pairs pairs = split(x, y, z);
  EXPECT_EQ(pairs.low[0], 0x1p-30f);
  EXPECT_EQ(pairs.low[1], 0x1p-29f);
  EXPECT_EQ(pairs.low[2], 0x1p-28f);
#if !defined(__clang__)
  const Pairs control = splitVectorised(x, y, z);
  std::cout << "control, basic-block vectoriser on: low words " << control.low[0] << ' ' << control.low[1] << ' '
            << control.low[2] << '\n';
#endif
}

TEST(StrictMath, ProductsAreNotContractedIntoSums) {
  if (!cpuHasFma()) GTEST_SKIP() << "this CPU cannot contract";
  // (1 + 2^-27)^2 = 1 + 2^-26 + 2^-54: the last term is lost when the product is rounded, and kept when it is fused.
  const volatile double a = 1.0 + 0x1p-27;
  const volatile double c = -(1.0 + 0x1p-26);
  EXPECT_EQ(productPlus(a, a, c), 0.0);
  EXPECT_EQ(std::fma(a, a, c), 0x1p-54);
  const volatile float af = 1.0f + 0x1p-13f;
  const volatile float cf = -(1.0f + 0x1p-12f);
  EXPECT_EQ(productPlus(af, af, cf), 0.0f);
  EXPECT_EQ(cross(a, a, a, a), 0.0) << "fused, this is 2^-54";
  std::cout << "control, contraction allowed: " << contracted(a, a, c) << '\n';
#if defined(__OPTIMIZE__) || !defined(__clang__)
  EXPECT_NE(contracted(a, a, c), 0.0) << "the probe cannot see contraction";
#endif
}

TEST(StrictMath, ExpressionsAreEvaluatedAsWritten) {
  const volatile double large = 0x1p53;
  const volatile double one = 1.0;
  EXPECT_EQ((one + large) - large, 0.0) << "reassociated";
  const volatile double third = 3.0;
  EXPECT_EQ(one / third * third, 1.0);
  const volatile double x = 5.0, y = 49.0;
  EXPECT_NE(x / y, x * (one / y)) << "division turned into a product with the reciprocal";
  const volatile float f = 16777216.0f;
  EXPECT_EQ((f + 1.0f) - f, 0.0f) << "float evaluated in a wider type";
}

TEST(StrictMath, DenormalsZerosAndNaNAreKept) {
  const volatile double tiny = std::numeric_limits<double>::min();
  EXPECT_GT(tiny * 0.5, 0.0) << "denormals flushed";
  const volatile float tinyFloat = std::numeric_limits<float>::min();
  EXPECT_GT(tinyFloat * 0.5f, 0.0f) << "denormals flushed";
  const volatile double zero = 0.0;
  EXPECT_TRUE(std::signbit(-zero));
  EXPECT_FALSE(std::signbit(-zero + 0.0));
  const volatile double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(nan != nan);
  EXPECT_FALSE(nan < 1.0 || nan >= 1.0);
}

TEST(StrictMath, SquareRootAndDivisionAreCorrectlyRounded) {
  const volatile double two = 2.0;
  EXPECT_EQ(std::sqrt(two), 0x1.6a09e667f3bcdp+0);
  const volatile float twoFloat = 2.0f;
  EXPECT_EQ(std::sqrt(twoFloat), 0x1.6a09e6p+0f);
  EXPECT_EQ(1.0f / std::sqrt(twoFloat), 0x1.6a09e6p-1f);
  const volatile double ten = 10.0;
  EXPECT_EQ(1.0 / ten, 0x1.999999999999ap-4);
}

}  // namespace
}  // namespace terrane

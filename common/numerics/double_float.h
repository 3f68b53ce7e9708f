#pragma once
// Double-float: a number as the unevaluated sum of two floats, hi + lo with |lo| <= ulp(hi)/2, for places that have
// floats only (a vertex shader) but need about 48 bits: 7.5 nm at the Earth's radius. The algorithms stand in
// double_float_operations.glsl, one source for C++ and for shaders; what is added here is what a float does by itself:
// zeros keep their sign, infinities and NaN stay what they are.
//
// u = 2^-24. Each function states its proven bound on the relative error in units of u^2, as a constant, and where the
// proof is:
//   [JMP17]    Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
//              arithmetic", ACM TOMS 44(2), 2017
//   [MR22]     Muller, Rideau, "Formalization of double-word arithmetic, and comments on [JMP17]", ACM TOMS 48(1), 2022
//   [LLMPR23]  Lefevre, Louvet, Muller, Picot, Rideau, "Accurate calculation of Euclidean norms using double-word
//              arithmetic", ACM TOMS 49(1), 2023
// tests/numeric measures all of them, and tests/capture the shaders' forms. The "sloppy" sum of [JMP17] has no bound
// for opposite signs and is not here.
//
// The bounds hold while operands and results have magnitudes in 2^-40 .. 2^100 (10^-12 .. 10^30). In a shader division
// need only be good to 2.5 units in the last place and sqrt to what follows from that: where a GPU makes use of it, the
// quotients' bounds are 55 u^2 and the root's 110 u^2 (our sums, to first order in u^2).
//
// What is not such a number, in every function from fromDouble on (each is tested with each of them):
//   NaN, infinity  hi is what the same float operation gives, lo is 0
//   overflow       the same: hi infinite, lo 0
//   +-0            as float has it, sign included
//   denormals      exact in sums. In products, quotients and roots an error term below 2^-149 is lost: the result
//   decays
//                  to a plain float's accuracy (8 u, or 2^-148), and to 0 where a float's does
//   from 2^127 on  a plain float's accuracy: what is in between overflows
// The error-free transforms are bare: NaN or infinity in an operand, or an overflow, leaves NaN or infinity in hi or
// lo, never a finite wrong number; the error of +-0 is +0.
// Thread-safe.

#include <algorithm>
#include <cassert>
#include <cmath>
#include <compare>

#include "common/numerics/strict_math.h"

namespace terrane {

struct DoubleFloat {
  constexpr DoubleFloat() noexcept = default;
  constexpr DoubleFloat(float high, float low) noexcept : hi(high), lo(low) {}

  float hi = 0;
  float lo = 0;
};

/// u and u^2 of float.
inline constexpr double kFloatUnit = 0x1p-24;
inline constexpr double kFloatUnitSquared = 0x1p-48;

/// The bare algorithms on floats: what a shader computes.
namespace double_float_bare {

using std::fma;
using std::sqrt;

inline float inverseRoot(float x) noexcept { return 1.0f / sqrt(x); }

/// Veltkamp's split into 12 + 12 bits. 4097 x overflows above 2^115: such a value is split 2^13 times smaller.
inline DoubleFloat splitFloat(float x) noexcept {
  const bool large = std::fabs(x) > 0x1p115f;
  const float a = large ? x * 0x1p-13f : x;
  const float scaled = 4097.0f * a;
  const float hi = scaled - (scaled - a);
  return large ? DoubleFloat(hi * 0x1p13f, (a - hi) * 0x1p13f) : DoubleFloat(hi, a - hi);
}

#define REAL float
#define PAIR DoubleFloat
#define PRECISE
#define FUNCTION inline
#define INVERSE_ROOT inverseRoot
#define HAS_FMA
#define OWN_SPLIT
#include "common/numerics/double_float_operations.glsl"
#undef REAL
#undef PAIR
#undef PRECISE
#undef FUNCTION
#undef INVERSE_ROOT
#undef HAS_FMA
#undef OWN_SPLIT

}  // namespace double_float_bare

namespace double_float_detail {

constexpr bool isFinite(float x) noexcept { return x - x == 0; }

/// A bare sum, given what the float operation alone gives: where that is not finite, or everything is 0, it has the
/// right kind and sign.
constexpr DoubleFloat settleSum(float plain, const DoubleFloat& bare) noexcept {
  if (!isFinite(plain)) return {plain, 0.0f};
  if (bare.hi == 0) return {plain == 0 ? plain : 0.0f, 0.0f};
  if (bare.hi != bare.hi) return {plain, 0.0f};  // near the largest float, where what is in between overflows
  return {bare.hi, isFinite(bare.hi) ? bare.lo : 0.0f};
}

/// A bare product, quotient or root is never further from the float operation's result than that may be from the exact
/// one, 3.5 u. Where it seems so, what was to be the error term has drowned among denormals.
constexpr DoubleFloat settle(float plain, const DoubleFloat& bare) noexcept {
  const float away = bare.hi - plain, room = (plain < 0 ? -plain : plain) * 0x1p-22f;
  const bool near = plain != 0 && (away < 0 ? -away : away) <= room;
  return isFinite(plain) && near && isFinite(bare.lo) ? bare : DoubleFloat{plain, 0.0f};
}

}  // namespace double_float_detail

// ---- error-free transforms: hi is the rounded result, hi + lo the exact one ----

/// Exact for any two floats below 2^127 (Knuth; 6 operations).
inline DoubleFloat twoSum(float a, float b) noexcept { return double_float_bare::twoSum(a, b); }

/// As twoSum with 3 operations. Precondition: |a| >= |b| or a = 0 (Dekker); the other way round it may lose all of a's
/// last bits.
inline DoubleFloat fastTwoSum(float a, float b) noexcept {
  assert(a == 0 || !(std::fabs(a) < std::fabs(b)));
  return double_float_bare::fastTwoSum(a, b);
}

/// The exact product by Dekker's split (17 operations), for machines without a fused multiply-add: and, since its
/// operations are a shader's too, the form that everything below uses. Exact for |a|, |b| < 2^127 and
/// 2^-102 <= |a b| < 2^127 (or a b = 0).
inline DoubleFloat twoProd(float a, float b) noexcept { return double_float_bare::twoProd(a, b); }

/// The same by a fused multiply-add: 2 operations where the hardware has it. Exact for 2^-102 <= |a b| <= FLT_MAX.
inline DoubleFloat twoProdFma(float a, float b) noexcept { return double_float_bare::twoProdFma(a, b); }

// ---- conversions ----

/// Within u^2 / 2: 2.7e-4 m at 1 AU. Beyond float's range: infinite.
constexpr DoubleFloat fromDouble(double value) noexcept {
  const float hi = static_cast<float>(value);
  if (!double_float_detail::isFinite(hi) || hi == 0) return {hi, 0.0f};
  return {hi, static_cast<float>(value - static_cast<double>(hi))};
}
inline constexpr double kFromDoubleBound = 0.5;

/// Exact for every pair that spans 53 bits or less, else rounded to nearest.
constexpr double toDouble(const DoubleFloat& x) noexcept {
  return x.lo == 0 ? static_cast<double>(x.hi) : static_cast<double>(x.hi) + static_cast<double>(x.lo);
}

// ---- sums ----

constexpr DoubleFloat operator-(const DoubleFloat& x) noexcept { return {-x.hi, -x.lo}; }

/// [JMP17] algorithm 4: 2 u^2. 10 operations.
inline DoubleFloat add(const DoubleFloat& x, float y) noexcept {
  return double_float_detail::settleSum(x.hi + y, double_float_bare::addFloat(x, y));
}
inline constexpr double kAddFloatBound = 2.0;

/// [JMP17] algorithm 6 ("accurate"): 3 u^2 + 13 u^3, signs alike or not. 20 operations.
inline DoubleFloat add(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  return double_float_detail::settleSum(x.hi + y.hi, double_float_bare::addPair(x, y));
}
inline constexpr double kAddBound = 3.0 + 13.0 * kFloatUnit;

inline DoubleFloat subtract(const DoubleFloat& x, const DoubleFloat& y) noexcept { return add(x, -y); }

/// x + y as a float: rounded once from the accurate sum, so its relative error is below u + 4 u^2, however much
/// cancels. 18 operations.
inline float addAndDemote(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const float plain = x.hi + y.hi;
  if (!double_float_detail::isFinite(plain)) return plain;
  const float sum = double_float_bare::addPairToFloat(x, y);
  if (sum != sum) return plain;
  return sum == 0 && plain == 0 ? plain : sum;  // the sign of 0 as a float has it
}
/// x - y as a float: what placing a vertex relative to the camera needs.
inline float subtractAndDemote(const DoubleFloat& x, const DoubleFloat& y) noexcept { return addAndDemote(x, -y); }
/// In units of u, not u^2.
inline constexpr double kSubtractAndDemoteBound = 1.0 + 4.0 * kFloatUnit;

/// x - y as a float, word by word: (x.hi - y.hi) + (x.lo - y.lo), 3 operations. Where x and y are within a factor of 2
/// the high words' difference is exact (Sterbenz), the low words' is off by u^2 (|x| + |y|) at most, and their sum is
/// rounded once; elsewhere two roundings are all that counts. So the relative error is at most
///   max(2 u, u + u^2 (|x| + |y|) / |x - y|)
/// but for higher orders (our derivation): as good as a float until x and y differ by less than 2^-24 of their size,
/// and then worse and worse; in metres always nothing, u^2 of the distance from the origin.
inline float subtractWordsAndDemote(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const float plain = x.hi - y.hi;
  if (!double_float_detail::isFinite(plain)) return plain;
  const float difference = double_float_bare::subtractWordsToFloat(x, y);
  return difference == 0 && plain == 0 ? plain : difference;
}
/// In units of u, with room for the higher orders; closeness = |x - y| / (|x| + |y|).
constexpr double subtractWordsBound(double closeness) noexcept {
  return std::max(2.0, 1.0 + kFloatUnit / closeness) * (1 + 0x1p-20);
}

// ---- products, quotients, roots ----

/// [JMP17] algorithm 7: 1.5 u^2 + 4 u^3.
inline DoubleFloat multiply(const DoubleFloat& x, float y) noexcept {
  return double_float_detail::settle(x.hi * y, double_float_bare::multiplyFloat(x, y));
}
inline constexpr double kMultiplyFloatBound = 1.5 + 4.0 * kFloatUnit;

/// [JMP17] algorithm 10: 7 u^2 there, 5 u^2 by [MR22].
inline DoubleFloat multiply(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  return double_float_detail::settle(x.hi * y.hi, double_float_bare::multiplyPair(x, y));
}
inline constexpr double kMultiplyBound = 5.0;

/// [JMP17] algorithm 15: 3 u^2.
inline DoubleFloat divide(const DoubleFloat& x, float y) noexcept {
  return double_float_detail::settle(x.hi / y, double_float_bare::divideFloat(x, y));
}
inline constexpr double kDivideFloatBound = 3.0;

/// [JMP17] algorithm 17: 15 u^2 + 56 u^3.
inline DoubleFloat divide(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  return double_float_detail::settle(x.hi / y.hi, double_float_bare::dividePair(x, y));
}
inline constexpr double kDivideBound = 15.0 + 56.0 * kFloatUnit;

/// [LLMPR23] algorithm SQRTDWtoDW: 25/8 u^2. NaN below 0.
inline DoubleFloat squareRoot(const DoubleFloat& x) noexcept {
  return double_float_detail::settle(std::sqrt(x.hi), double_float_bare::squareRootPair(x));
}
inline constexpr double kSquareRootBound = 25.0 / 8.0;

/// 1/sqrt(x) by one Newton step, r + r/2 (1 - x r^2), from r = float(1/sqrt(hi)). The bound is ours, to first order in
/// u^2: three roundings leave x r^2 = 1 + t with |t| <= 5 u, and the step's own 3/8 t^2 is 9.4 u^2; the product's 5 u^2
/// and the rounding of the residual (5 u^2) count half; the rounding of the correction is 2.5 u^2: 16.9 u^2. A shader
/// begins with its hardware's r, good to 2 units in the last place: |t| <= 9 u, and 30.4 + 2.5 + 4.5 + 4.5 = 42 u^2.
/// Infinite at 0, NaN below.
inline DoubleFloat inverseSquareRoot(const DoubleFloat& x) noexcept {
  return double_float_detail::settle(double_float_bare::inverseRoot(x.hi), double_float_bare::inverseSquareRootPair(x));
}
inline constexpr double kInverseSquareRootBound = 17.0;
inline constexpr double kInverseSquareRootShaderBound = 42.0;

// ---- order ----

/// By value; unordered when either is NaN.
constexpr std::partial_ordering compare(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const std::partial_ordering high = x.hi <=> y.hi;
  return high == std::partial_ordering::equivalent ? x.lo <=> y.lo : high;
}

}  // namespace terrane

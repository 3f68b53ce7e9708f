#pragma once
// Double-float: a number as the unevaluated sum of two floats, hi + lo with |lo| <= ulp(hi)/2, for places that have
// floats only (a vertex shader) but need about 48 bits: 7.5 nm at the Earth's radius. These are the CPU's functions;
// their GLSL twins do the same.
//
// u = 2^-24. Each function states its proven bound on the relative error in units of u^2, as a constant, and where the
// proof is:
//   [JMP17]  Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
//   arithmetic", ACM
//            TOMS 44(2), 2017
//   [MR22]   Muller, Rideau, "Formalization of double-word arithmetic, and comments on [JMP17]", ACM TOMS 48(1), 2022
//   [LLMPR23] Lefevre, Louvet, Muller, Picot, Rideau, "Accurate calculation of Euclidean norms using double-word
//   arithmetic", ACM
//            TOMS 49(1), 2023
// tests/numeric measures all of them. The "sloppy" sum of [JMP17] has no bound for opposite signs
// and is not here.
//
// The bounds hold while operands and results have magnitudes in 2^-40 .. 2^100 (10^-12 .. 10^30). Far below, an error
// term falls under the smallest denormal and the result decays to a plain float's accuracy. Zeros (with their sign),
// infinities and NaN come out in hi as the same float operation gives them, with lo = 0; so does overflow. Thread-safe.

#include <cassert>
#include <cmath>
#include <compare>

#include "common/numerics/strict_math.h"

namespace terrane {

struct DoubleFloat {
  float hi = 0;
  float lo = 0;
};

/// u and u^2 of float.
inline constexpr double kFloatUnit = 0x1p-24;
inline constexpr double kFloatUnitSquared = 0x1p-48;

namespace double_float_detail {

constexpr float magnitude(float x) noexcept { return x < 0 ? -x : x; }
constexpr bool isFinite(float x) noexcept { return x - x == 0; }

struct Halves {
  float high, low;
};

/// Veltkamp's split into 12 + 12 bits. 4097 x overflows above 2^115: such a value is split 2^13 times smaller.
constexpr Halves split(float x) noexcept {
  const bool large = magnitude(x) > 0x1p115f;
  const float scaled = large ? x * 0x1p-13f : x;
  const float c = 4097.0f * scaled;
  const float high = c - (c - scaled);
  return Halves{large ? high * 0x1p13f : high, large ? (scaled - high) * 0x1p13f : scaled - high};
}

}  // namespace double_float_detail

// ---- error-free transforms: hi is the rounded result, hi + lo the exact one ----

/// Exact for any two finite floats whose sum does not overflow (Knuth; 6 operations).
constexpr DoubleFloat twoSum(float a, float b) noexcept {
  const float s = a + b;
  const float aPart = s - b;
  const float bPart = s - aPart;
  return DoubleFloat{s, (a - aPart) + (b - bPart)};
}

namespace double_float_detail {

/// As twoSum with 3 operations, for callers that have proven it exact: |a| >= |b|, or a = 0, or at least a multiple of
/// ulp(b), which is all that [JMP17] can show (and need) where high words cancel.
constexpr DoubleFloat sumOfOrdered(float a, float b) noexcept {
  const float s = a + b;
  return DoubleFloat{s, b - (s - a)};
}

}  // namespace double_float_detail

/// As twoSum with 3 operations. Precondition: |a| >= |b| or a = 0 (Dekker); the other way round it may lose all of a's
/// last bits.
constexpr DoubleFloat fastTwoSum(float a, float b) noexcept {
  assert(a == 0 || !(double_float_detail::magnitude(a) < double_float_detail::magnitude(b)));
  return double_float_detail::sumOfOrdered(a, b);
}

/// The exact product by Dekker's split, for machines without a fused multiply-add: and, since its operations are a
/// shader's too, the form that everything below uses. Exact for 2^-102 <= |a b| < 2^127 (or a b = 0).
constexpr DoubleFloat twoProd(float a, float b) noexcept {
  const double_float_detail::Halves x = double_float_detail::split(a);
  const double_float_detail::Halves y = double_float_detail::split(b);
  const float p = a * b;
  return DoubleFloat{p, ((x.high * y.high - p) + x.high * y.low + x.low * y.high) + x.low * y.low};
}

/// The same by a fused multiply-add: 2 operations where the hardware has it. Exact for 2^-102 <= |a b| <= FLT_MAX.
inline DoubleFloat twoProdFma(float a, float b) noexcept {
  const float p = a * b;
  return DoubleFloat{p, std::fma(a, b, -p)};
}

namespace double_float_detail {

/// What remains of a result once its parts are known: renormalised; but where the float operation alone gives a value
/// that is not finite, or everything is 0, that value itself, whose sign and kind are right.
constexpr DoubleFloat finish(float plain, float hi, float lo) noexcept {
  if (!isFinite(plain)) return DoubleFloat{plain, 0.0f};
  if (hi == 0 && lo == 0) return DoubleFloat{plain == 0 ? plain : 0.0f, 0.0f};
  const DoubleFloat sum = sumOfOrdered(hi, lo);
  return isFinite(sum.hi) ? sum : DoubleFloat{sum.hi, 0.0f};
}

}  // namespace double_float_detail

// ---- conversions ----

/// Within u^2: 2.5e-4 m at 1 AU. Beyond float's range: infinite.
constexpr DoubleFloat fromDouble(double value) noexcept {
  const float hi = static_cast<float>(value);
  if (!double_float_detail::isFinite(hi) || hi == 0) return DoubleFloat{hi, 0.0f};
  return DoubleFloat{hi, static_cast<float>(value - static_cast<double>(hi))};
}
inline constexpr double kFromDoubleBound = 1.0;

/// Exact for every pair that spans 53 bits or less, else rounded to nearest.
constexpr double toDouble(const DoubleFloat& x) noexcept {
  return x.lo == 0 ? static_cast<double>(x.hi) : static_cast<double>(x.hi) + static_cast<double>(x.lo);
}

// ---- arithmetic ----

constexpr DoubleFloat operator-(const DoubleFloat& x) noexcept { return DoubleFloat{-x.hi, -x.lo}; }

/// [JMP17] algorithm 4: 2 u^2. 10 operations.
constexpr DoubleFloat add(const DoubleFloat& x, float y) noexcept {
  const DoubleFloat s = twoSum(x.hi, y);
  return double_float_detail::finish(s.hi, s.hi, x.lo + s.lo);
}
inline constexpr double kAddFloatBound = 2.0;

/// [JMP17] algorithm 6 ("accurate"): 3 u^2 + 13 u^3, signs alike or not. 20 operations.
constexpr DoubleFloat add(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const DoubleFloat s = twoSum(x.hi, y.hi);
  if (!double_float_detail::isFinite(s.hi)) return DoubleFloat{s.hi, 0.0f};
  const DoubleFloat t = twoSum(x.lo, y.lo);
  const DoubleFloat v = double_float_detail::sumOfOrdered(s.hi, s.lo + t.hi);
  return double_float_detail::finish(s.hi, v.hi, t.lo + v.lo);
}
inline constexpr double kAddBound = 3.0 + 13.0 * kFloatUnit;

constexpr DoubleFloat subtract(const DoubleFloat& x, const DoubleFloat& y) noexcept { return add(x, -y); }

/// x - y as a float, what placing a vertex relative to the camera needs: rounded once from the accurate difference, so
/// its relative error is below u + 4 u^2, however much cancels. 18 operations.
constexpr float subtractAndDemote(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const DoubleFloat s = twoSum(x.hi, -y.hi);
  if (!double_float_detail::isFinite(s.hi)) return s.hi;
  const DoubleFloat t = twoSum(x.lo, -y.lo);
  const DoubleFloat v = double_float_detail::sumOfOrdered(s.hi, s.lo + t.hi);
  const float difference = v.hi + (t.lo + v.lo);
  return difference == 0 && s.hi == 0 ? s.hi : difference;  // the sign of 0 as a float has it
}
/// In units of u, not u^2.
inline constexpr double kSubtractAndDemoteBound = 1.0 + 4.0 * kFloatUnit;

/// [JMP17] algorithm 7: 1.5 u^2 + 4 u^3.
constexpr DoubleFloat multiply(const DoubleFloat& x, float y) noexcept {
  const float plain = x.hi * y;
  if (!double_float_detail::isFinite(plain) || plain == 0) return DoubleFloat{plain, 0.0f};
  const DoubleFloat c = twoProd(x.hi, y);
  const DoubleFloat t = double_float_detail::sumOfOrdered(c.hi, x.lo * y);
  return double_float_detail::finish(plain, t.hi, t.lo + c.lo);
}
inline constexpr double kMultiplyFloatBound = 1.5 + 4.0 * kFloatUnit;

/// [JMP17] algorithm 10: 7 u^2 there, 5 u^2 by [MR22].
constexpr DoubleFloat multiply(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const float plain = x.hi * y.hi;
  if (!double_float_detail::isFinite(plain) || plain == 0) return DoubleFloat{plain, 0.0f};
  const DoubleFloat c = twoProd(x.hi, y.hi);
  return double_float_detail::finish(plain, c.hi, c.lo + (x.hi * y.lo + x.lo * y.hi));
}
inline constexpr double kMultiplyBound = 5.0;

/// [JMP17] algorithm 15: 3 u^2.
constexpr DoubleFloat divide(const DoubleFloat& x, float y) noexcept {
  const float quotient = x.hi / y;
  if (!double_float_detail::isFinite(quotient) || quotient == 0) return DoubleFloat{quotient, 0.0f};
  if (!double_float_detail::isFinite(y)) return DoubleFloat{quotient, 0.0f};
  const DoubleFloat p = twoProd(quotient, y);
  const float remainder = ((x.hi - p.hi) - p.lo) + x.lo;
  return double_float_detail::finish(quotient, quotient, remainder / y);
}
inline constexpr double kDivideFloatBound = 3.0;

/// [JMP17] algorithm 17: 15 u^2 + 56 u^3.
constexpr DoubleFloat divide(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const float quotient = x.hi / y.hi;
  if (!double_float_detail::isFinite(quotient) || quotient == 0) return DoubleFloat{quotient, 0.0f};
  const DoubleFloat r = multiply(y, quotient);
  const float remainder = (x.hi - r.hi) + (x.lo - r.lo);
  return double_float_detail::finish(quotient, quotient, remainder / y.hi);
}
inline constexpr double kDivideBound = 15.0 + 56.0 * kFloatUnit;

/// [LLMPR23] algorithm SQRTDWtoDW: 25/8 u^2. The residual hi - root^2 is a float, so that the product's two parts give
/// it exactly without a fused multiply-add. NaN below 0.
inline DoubleFloat squareRoot(const DoubleFloat& x) noexcept {
  const float root = std::sqrt(x.hi);
  if (!double_float_detail::isFinite(root) || root == 0) return DoubleFloat{root, 0.0f};
  const DoubleFloat p = twoProd(root, root);
  const float residual = x.lo + ((x.hi - p.hi) - p.lo);
  return double_float_detail::finish(root, root, residual / (2.0f * root));
}
inline constexpr double kSquareRootBound = 25.0 / 8.0;

/// 1/sqrt(x) by one Newton step, r + r/2 (1 - x r^2), from r = float(1/sqrt(hi)). The bound is ours, to first order in
/// u^2: three roundings leave x r^2 = 1 + t with |t| <= 5 u, and the step's own 3/8 t^2 is 9.4 u^2; the product's 5 u^2
/// and the rounding of the residual (5 u^2) count half; the rounding of the correction is 2.5 u^2: 16.9 u^2. Infinite
/// at 0, NaN below.
inline DoubleFloat inverseSquareRoot(const DoubleFloat& x) noexcept {
  const float r = 1.0f / std::sqrt(x.hi);
  if (!double_float_detail::isFinite(r) || r == 0) return DoubleFloat{r, 0.0f};
  const DoubleFloat product = multiply(x, twoProd(r, r));
  const float residual = (1.0f - product.hi) - product.lo;
  return double_float_detail::finish(r, r, r * (0.5f * residual));
}
inline constexpr double kInverseSquareRootBound = 17.0;

/// By value; unordered when either is NaN.
constexpr std::partial_ordering compare(const DoubleFloat& x, const DoubleFloat& y) noexcept {
  const std::partial_ordering high = x.hi <=> y.hi;
  return high == std::partial_ordering::equivalent ? x.lo <=> y.lo : high;
}

}  // namespace terrane

// Double-float's algorithms, one source for both worlds: shaders include it as GLSL, double_float.h as C++. Who includes it says what
//   REAL          is computed with: float, or vec3 for three numbers at once
//   PAIR          holds two of them: a struct with members hi and lo
//   PRECISE       is: GLSL's qualifier, without which compilers simplify the error terms to 0; nothing in C++, where the compiler is told
//                 once for all
//   FUNCTION      stands before a function: inline in C++, nothing in GLSL
//   INVERSE_ROOT  gives 1 / sqrt(x): the hardware's instruction in GLSL
//   HAS_FMA       (may be left out) says that fma() is there; not that it is fused
//   OWN_SPLIT     (may be left out) says that splitFloat is there already: C++ brings one that does not overflow
//   OWN_PROD      (may be left out) says that twoProd is there already: where a fused multiply-add is known to be fused
//
// Bounds and sources are in double_float.h. These are the bare algorithms, for finite operands and results of magnitude 2^-40 .. 2^100, or 0;
// what is not finite spoils hi or lo, and the sign of a zero may be lost.
// Every step is a statement of its own: PRECISE belongs to a variable.

// Knuth, 6 operations: hi + lo is exactly a + b, in any order of magnitude.
FUNCTION PAIR twoSum(REAL a, REAL b) {
  PRECISE REAL sum = a + b;
  PRECISE REAL aPart = sum - b;
  PRECISE REAL bPart = sum - aPart;
  PRECISE REAL aError = a - aPart;
  PRECISE REAL bError = b - bPart;
  PRECISE REAL error = aError + bError;
  return PAIR(sum, error);
}

// Dekker, 3 operations: the same for |a| >= |b|, or a = 0, or a at least a multiple of ulp(b).
FUNCTION PAIR fastTwoSum(REAL a, REAL b) {
  PRECISE REAL sum = a + b;
  PRECISE REAL bPart = sum - a;
  PRECISE REAL error = b - bPart;
  return PAIR(sum, error);
}

#ifndef OWN_SPLIT
// Veltkamp, 4 operations: a = hi + lo with 12 bits each. Overflows above 2^115.
FUNCTION PAIR splitFloat(REAL a) {
  PRECISE REAL scaled = 4097.0f * a;
  PRECISE REAL rest = scaled - a;
  PRECISE REAL hi = scaled - rest;
  PRECISE REAL lo = a - hi;
  return PAIR(hi, lo);
}
#endif

#ifndef OWN_PROD
// Dekker, 17 operations: hi + lo is exactly a b.
FUNCTION PAIR twoProd(REAL a, REAL b) {
  PAIR as = splitFloat(a);
  PAIR bs = splitFloat(b);
  PRECISE REAL product = a * b;
  PRECISE REAL highHigh = as.hi * bs.hi;
  PRECISE REAL e1 = highHigh - product;
  PRECISE REAL highLow = as.hi * bs.lo;
  PRECISE REAL e2 = e1 + highLow;
  PRECISE REAL lowHigh = as.lo * bs.hi;
  PRECISE REAL e3 = e2 + lowHigh;
  PRECISE REAL lowLow = as.lo * bs.lo;
  PRECISE REAL error = e3 + lowLow;
  return PAIR(product, error);
}
#endif

#ifdef HAS_FMA
// 2 operations, exact where fma() rounds once. In a shader no one promises that, and llvmpipe's does not: there this is the control.
FUNCTION PAIR twoProdFma(REAL a, REAL b) {
  PRECISE REAL product = a * b;
  PRECISE REAL error = fma(a, b, -product);
  return PAIR(product, error);
}
#endif

FUNCTION PAIR negativePair(PAIR x) { return PAIR(-x.hi, -x.lo); }

// DWPlusFP, algorithm 4 of [JMP17]: 10 operations.
FUNCTION PAIR addFloat(PAIR x, REAL y) {
  PAIR s = twoSum(x.hi, y);
  PRECISE REAL lo = x.lo + s.lo;
  return fastTwoSum(s.hi, lo);
}

// AccurateDWPlusDW, algorithm 6: 20 operations.
FUNCTION PAIR addPair(PAIR x, PAIR y) {
  PAIR s = twoSum(x.hi, y.hi);
  PAIR t = twoSum(x.lo, y.lo);
  PRECISE REAL c = s.lo + t.hi;
  PAIR v = fastTwoSum(s.hi, c);
  PRECISE REAL w = t.lo + v.lo;
  return fastTwoSum(v.hi, w);
}

// The same rounded to one float: 18 operations, for a sum that is wanted as a float needs no last renormalisation.
FUNCTION REAL addPairToFloat(PAIR x, PAIR y) {
  PAIR s = twoSum(x.hi, y.hi);
  PAIR t = twoSum(x.lo, y.lo);
  PRECISE REAL c = s.lo + t.hi;
  PAIR v = fastTwoSum(s.hi, c);
  PRECISE REAL w = t.lo + v.lo;
  PRECISE REAL sum = v.hi + w;
  return sum;
}

FUNCTION REAL subtractPairToFloat(PAIR x, PAIR y) { return addPairToFloat(x, negativePair(y)); }

// Word by word, 3 operations.
FUNCTION REAL subtractWordsToFloat(PAIR x, PAIR y) {
  PRECISE REAL hi = x.hi - y.hi;
  PRECISE REAL lo = x.lo - y.lo;
  PRECISE REAL difference = hi + lo;
  return difference;
}

// DWTimesFP1, algorithm 7.
FUNCTION PAIR multiplyFloat(PAIR x, REAL y) {
  PAIR c = twoProd(x.hi, y);
  PRECISE REAL low = x.lo * y;
  PAIR t = fastTwoSum(c.hi, low);
  PRECISE REAL rest = t.lo + c.lo;
  return fastTwoSum(t.hi, rest);
}

// DWTimesDW1, algorithm 10.
FUNCTION PAIR multiplyPair(PAIR x, PAIR y) {
  PAIR c = twoProd(x.hi, y.hi);
  PRECISE REAL highLow = x.hi * y.lo;
  PRECISE REAL lowHigh = x.lo * y.hi;
  PRECISE REAL cross = highLow + lowHigh;
  PRECISE REAL rest = c.lo + cross;
  return fastTwoSum(c.hi, rest);
}

// DWDivFP3, algorithm 15.
FUNCTION PAIR divideFloat(PAIR x, REAL y) {
  PRECISE REAL quotient = x.hi / y;
  PAIR p = twoProd(quotient, y);
  PRECISE REAL high = x.hi - p.hi;
  PRECISE REAL rest = high - p.lo;
  PRECISE REAL remainder = rest + x.lo;
  PRECISE REAL correction = remainder / y;
  return fastTwoSum(quotient, correction);
}

// DWDivDW2, algorithm 17.
FUNCTION PAIR dividePair(PAIR x, PAIR y) {
  PRECISE REAL quotient = x.hi / y.hi;
  PAIR r = multiplyFloat(y, quotient);
  PRECISE REAL high = x.hi - r.hi;
  PRECISE REAL low = x.lo - r.lo;
  PRECISE REAL remainder = high + low;
  PRECISE REAL correction = remainder / y.hi;
  return fastTwoSum(quotient, correction);
}

// SQRTDWtoDW of [LLMPR23]. The residual hi - root^2 is a float: the product's two parts give it exactly without a fused multiply-add.
FUNCTION PAIR squareRootPair(PAIR x) {
  PRECISE REAL root = sqrt(x.hi);
  PAIR p = twoProd(root, root);
  PRECISE REAL high = x.hi - p.hi;
  PRECISE REAL rest = high - p.lo;
  PRECISE REAL residual = x.lo + rest;
  PRECISE REAL correction = residual / (2.0f * root);
  return fastTwoSum(root, correction);
}

// One Newton step r + r/2 (1 - x r^2) from the hardware's r.
FUNCTION PAIR inverseSquareRootPair(PAIR x) {
  PRECISE REAL r = INVERSE_ROOT(x.hi);
  PAIR product = multiplyPair(x, twoProd(r, r));
  PRECISE REAL high = REAL(1.0f) - product.hi;
  PRECISE REAL residual = high - product.lo;
  PRECISE REAL correction = r * (0.5f * residual);
  return fastTwoSum(r, correction);
}

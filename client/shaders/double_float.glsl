// Double-float: an unevaluated sum high + low of two floats, |low| <= ulp(high) / 2, about 48 bits; here three at once. The twin of
// common/numerics/double_float.h (Joldes, Muller, Popescu 2017, "Tight and rigorous error bounds for basic building blocks of
// double-word arithmetic"). Every intermediate is PRECISE: without it drivers simplify the error terms to 0.
struct DoubleFloat3 {
  vec3 high;
  vec3 low;
};

// Knuth: high + low is exactly a + b, in any order of magnitude.
DoubleFloat3 twoSum(vec3 a, vec3 b) {
  PRECISE vec3 high = a + b;
  PRECISE vec3 bPart = high - a;
  PRECISE vec3 aPart = high - bPart;
  PRECISE vec3 aError = a - aPart;
  PRECISE vec3 bError = b - bPart;
  PRECISE vec3 low = aError + bError;
  return DoubleFloat3(high, low);
}

// Dekker: the same for |a| >= |b| (or a = 0).
DoubleFloat3 fastTwoSum(vec3 a, vec3 b) {
  PRECISE vec3 high = a + b;
  PRECISE vec3 bPart = high - a;
  PRECISE vec3 low = b - bPart;
  return DoubleFloat3(high, low);
}

// Veltkamp: a = high + low with 12 bits each. Overflows above 2^115.
DoubleFloat3 splitFloat(vec3 a) {
  PRECISE vec3 scaled = 4097.0 * a;
  PRECISE vec3 rest = scaled - a;
  PRECISE vec3 high = scaled - rest;
  PRECISE vec3 low = a - high;
  return DoubleFloat3(high, low);
}

// Dekker: high + low is exactly a * b while nothing over- or underflows. fma() is no substitute: drivers may round it twice.
DoubleFloat3 twoProd(vec3 a, vec3 b) {
  DoubleFloat3 as = splitFloat(a);
  DoubleFloat3 bs = splitFloat(b);
  PRECISE vec3 high = a * b;
  PRECISE vec3 highHigh = as.high * bs.high;
  PRECISE vec3 e1 = highHigh - high;
  PRECISE vec3 highLow = as.high * bs.low;
  PRECISE vec3 e2 = e1 + highLow;
  PRECISE vec3 lowHigh = as.low * bs.high;
  PRECISE vec3 e3 = e2 + lowHigh;
  PRECISE vec3 lowLow = as.low * bs.low;
  PRECISE vec3 low = e3 + lowLow;
  return DoubleFloat3(high, low);
}

// DWPlusFP (algorithm 4): relative error <= 2 u^2.
DoubleFloat3 addFloat(DoubleFloat3 a, vec3 b) {
  DoubleFloat3 s = twoSum(a.high, b);
  PRECISE vec3 low = a.low + s.low;
  return fastTwoSum(s.high, low);
}

// AccurateDWPlusDW (algorithm 6) of a and -b, rounded to one float: the 20 operations that cancel safely, less the last two.
vec3 subtractToFloat(DoubleFloat3 a, DoubleFloat3 b) {
  DoubleFloat3 s = twoSum(a.high, -b.high);
  DoubleFloat3 t = twoSum(a.low, -b.low);
  PRECISE vec3 c = s.low + t.high;
  DoubleFloat3 v = fastTwoSum(s.high, c);
  PRECISE vec3 w = t.low + v.low;
  PRECISE vec3 sum = v.high + w;
  return sum;
}

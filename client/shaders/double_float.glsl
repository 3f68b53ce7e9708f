// Double-float: an unevaluated sum high + low of two floats, |low| <= ulp(high) / 2, about 48 bits. The twin of
// common/numerics/double_float.h (Joldes, Muller, Popescu 2017, "Tight and rigorous error bounds for basic building blocks of
// double-word arithmetic"). Every intermediate is PRECISE: without it drivers simplify the error terms to 0.

// Knuth: high + low is exactly a + b, in any order of magnitude. Returns (high, low).
vec2 twoSum(float a, float b) {
  PRECISE float high = a + b;
  PRECISE float bPart = high - a;
  PRECISE float aPart = high - bPart;
  PRECISE float aError = a - aPart;
  PRECISE float bError = b - bPart;
  PRECISE float low = aError + bError;
  return vec2(high, low);
}

// Dekker: the same for |a| >= |b| (or a = 0).
vec2 fastTwoSum(float a, float b) {
  PRECISE float high = a + b;
  PRECISE float bPart = high - a;
  PRECISE float low = b - bPart;
  return vec2(high, low);
}

// Veltkamp: a = high + low with 12 bits each. Overflows above 2^115.
vec2 splitFloat(float a) {
  PRECISE float scaled = 4097.0 * a;
  PRECISE float rest = scaled - a;
  PRECISE float high = scaled - rest;
  PRECISE float low = a - high;
  return vec2(high, low);
}

// Dekker: high + low is exactly a * b while nothing over- or underflows. fma() is no substitute: drivers may round it twice.
vec2 twoProd(float a, float b) {
  vec2 as = splitFloat(a);
  vec2 bs = splitFloat(b);
  PRECISE float high = a * b;
  PRECISE float highHigh = as.x * bs.x;
  PRECISE float e1 = highHigh - high;
  PRECISE float highLow = as.x * bs.y;
  PRECISE float e2 = e1 + highLow;
  PRECISE float lowHigh = as.y * bs.x;
  PRECISE float e3 = e2 + lowHigh;
  PRECISE float lowLow = as.y * bs.y;
  PRECISE float low = e3 + lowLow;
  return vec2(high, low);
}

// DWPlusFP (algorithm 4): relative error <= 2 u^2.
vec2 addFloat(vec2 a, float b) {
  vec2 s = twoSum(a.x, b);
  PRECISE float low = a.y + s.y;
  return fastTwoSum(s.x, low);
}

// AccurateDWPlusDW (algorithm 6) of a and -b, rounded to one float: the 20 operations that cancel safely, less the last two.
float subtractToFloat(vec2 a, vec2 b) {
  vec2 s = twoSum(a.x, -b.x);
  vec2 t = twoSum(a.y, -b.y);
  PRECISE float c = s.y + t.x;
  vec2 v = fastTwoSum(s.x, c);
  PRECISE float w = t.y + v.y;
  PRECISE float sum = v.x + w;
  return sum;
}

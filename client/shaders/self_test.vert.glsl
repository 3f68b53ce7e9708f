// Asks this GPU what its arithmetic does. Everything comes from attributes, so that no compiler can compute it ahead.
#include "double_float.glsl"

layout(location = 0) in vec2 pair;
layout(location = 1) in ivec2 integers;
layout(location = 2) in uvec4 offset;

out vec4 sums;         // TwoSum with PRECISE; without
out vec4 products;     // TwoProd by Dekker's split; by fma()
flat out ivec2 whole;  // integers.x + offset.x, and the bits of its float
out vec2 relative;     // that float; minus pair.x

vec2 twoSumUnqualified(float a, float b) {
  float high = a + b;
  float bPart = high - a;
  float aPart = high - bPart;
  return vec2(high, (a - aPart) + (b - bPart));
}

void main() {
  sums = vec4(twoSum(pair.x, pair.y), twoSumUnqualified(pair.x, pair.y));
  PRECISE float product = pair.x * pair.y;
#ifdef HAS_PRECISE
  PRECISE float error = fma(pair.x, pair.y, -product);
#else
  float error = 0.0;
#endif
  products = vec4(twoProd(pair.x, pair.y), product, error);
  int sum = integers.x + int(offset.x);
  PRECISE float converted = float(sum);
  PRECISE float difference = converted - pair.x;
  whole = ivec2(sum, floatBitsToInt(converted));
  relative = vec2(converted, difference);
  gl_Position = vec4(0.0);
}

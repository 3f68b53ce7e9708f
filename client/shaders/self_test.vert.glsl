// Asks this GPU what its arithmetic does. Everything comes from attributes, so that no compiler can compute it ahead. With
// UNQUALIFIED the same is asked without PRECISE: in a program of its own, or common subexpressions would lend it the qualified ones.
#ifdef UNQUALIFIED
#undef PRECISE
#define PRECISE
#endif
#include "double_float.glsl"

layout(location = 0) in vec2 pair;
layout(location = 1) in ivec2 integers;
layout(location = 2) in uvec4 offset;

out vec2 sums;         // TwoSum
out vec4 products;     // TwoProd by Dekker's split; by fma()
flat out ivec2 whole;  // integers.x + offset.x, and the bits of its float
out vec2 relative;     // that float; minus pair.x

void main() {
  DoubleFloat3 sum3 = twoSum(vec3(pair.x), vec3(pair.y));
  DoubleFloat3 product3 = twoProd(vec3(pair.x), vec3(pair.y));
  sums = vec2(sum3.hi.x, sum3.lo.x);
#ifdef HAS_FMA
  DoubleFloat3 fused3 = twoProdFma(vec3(pair.x), vec3(pair.y));
#else
  DoubleFloat3 fused3 = DoubleFloat3(vec3(0.0), vec3(0.0));
#endif
  products = vec4(product3.hi.x, product3.lo.x, fused3.hi.x, fused3.lo.x);
  int sum = integers.x + int(offset.x);
  PRECISE float converted = float(sum);
  PRECISE float difference = converted - pair.x;
  whole = ivec2(sum, floatBitsToInt(converted));
  relative = vec2(converted, difference);
  gl_Position = vec4(0.0);
}

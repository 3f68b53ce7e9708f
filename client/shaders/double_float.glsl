// Double-float, an unevaluated sum hi + lo of two floats, |lo| <= ulp(hi) / 2, about 48 bits; here three at once, with the algorithms of
// common/numerics/double_float.h.
struct DoubleFloat3 {
  vec3 hi;
  vec3 lo;
};
#define INVERSE_ROOT inversesqrt
#define REAL vec3
#define PAIR DoubleFloat3
#include "double_float_operations.glsl"
#undef REAL
#undef PAIR

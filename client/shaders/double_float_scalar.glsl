// The same for single numbers, and what needs both: lengths and directions. After double_float.glsl.
struct DoubleFloat {
  float hi;
  float lo;
};
#define REAL float
#define PAIR DoubleFloat
#include "double_float_operations.glsl"
#undef REAL
#undef PAIR
#include "double_float3_operations.glsl"

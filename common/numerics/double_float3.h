#pragma once
// Three double-floats: positions and directions, for the CPU to compute what a shader computes, bit for bit, and to
// prepare what a shader is given. Body frame or any other; metres or any other unit. The algorithms are shared with
// shaders (double_float_operations.glsl, double_float3_operations.glsl) and are bare: for finite components of
// magnitude 2^-40 .. 2^100 (whose squares, for lengths, are in that range too) or 0. NaN or infinity in a component
// leaves NaN or infinity in it; the sign of a zero may be lost. Thread-safe.
//
// Bounds are relative, in units of u^2 = 2^-48, and those of double_float.h for each component; below, what is built of
// them.

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/vec3.hpp>

#include "common/numerics/double_float.h"

namespace terrane {

struct DoubleFloat3 {
  DoubleFloat3() noexcept = default;
  DoubleFloat3(const glm::vec3& high, const glm::vec3& low) noexcept : hi(high), lo(low) {}

  glm::vec3 hi{0.0f};
  glm::vec3 lo{0.0f};
};

namespace double_float_bare {

using glm::sqrt;
using glm::vec3;

inline vec3 inverseRoot(const vec3& x) noexcept { return 1.0f / sqrt(x); }
inline DoubleFloat3 splitFloat(const vec3& a) noexcept {
  const DoubleFloat x = splitFloat(a.x), y = splitFloat(a.y), z = splitFloat(a.z);
  return {{x.hi, y.hi, z.hi}, {x.lo, y.lo, z.lo}};
}

#define REAL vec3
#define PAIR DoubleFloat3
#define PRECISE
#define FUNCTION inline
#define INVERSE_ROOT inverseRoot
#define OWN_SPLIT
#include "common/numerics/double_float_operations.glsl"
// built of the former:
#include "common/numerics/double_float3_operations.glsl"
#undef REAL
#undef PAIR
#undef PRECISE
#undef FUNCTION
#undef INVERSE_ROOT
#undef OWN_SPLIT

}  // namespace double_float_bare

/// Each component as fromDouble has it.
inline DoubleFloat3 fromDouble(const glm::dvec3& value) noexcept {
  const DoubleFloat x = fromDouble(value.x), y = fromDouble(value.y), z = fromDouble(value.z);
  return {{x.hi, y.hi, z.hi}, {x.lo, y.lo, z.lo}};
}
inline glm::dvec3 toDouble(const DoubleFloat3& x) noexcept { return glm::dvec3(x.hi) + glm::dvec3(x.lo); }

/// 2 u^2 (kAddFloatBound) a component.
inline DoubleFloat3 add(const DoubleFloat3& x, const glm::vec3& y) noexcept {
  return double_float_bare::addFloat(x, y);
}
/// kAddBound a component.
inline DoubleFloat3 add(const DoubleFloat3& x, const DoubleFloat3& y) noexcept {
  return double_float_bare::addPair(x, y);
}
/// u + 4 u^2 a component, however much cancels: a vertex relative to the camera.
inline glm::vec3 subtractAndDemote(const DoubleFloat3& x, const DoubleFloat3& y) noexcept {
  return double_float_bare::subtractPairToFloat(x, y);
}
/// subtractWordsBound of each component.
inline glm::vec3 subtractWordsAndDemote(const DoubleFloat3& x, const DoubleFloat3& y) noexcept {
  return double_float_bare::subtractWordsToFloat(x, y);
}
/// kMultiplyBound a component.
inline DoubleFloat3 multiply(const DoubleFloat3& x, const DoubleFloat& factor) noexcept {
  return double_float_bare::scalePair(x, factor);
}

/// Within 11 u^2 of |x y| summed over the axes: a product's 5 and two sums' 3 each. Relative only where no term
/// cancels, as in a square.
inline DoubleFloat dot(const DoubleFloat3& x, const DoubleFloat3& y) noexcept {
  return double_float_bare::dotPair(x, y);
}
inline constexpr double kDotBound = 11.0;

/// Half the square's 11 u^2, and the root's 25/8. 0 of the zero vector, whose bare length is NaN.
inline DoubleFloat length(const DoubleFloat3& x) noexcept { return squareRoot(dot(x, x)); }
inline constexpr double kLengthBound = 5.5 + kSquareRootBound;

/// Half the square's 11 u^2, the inverse root's and the last product's 5, a component. NaN of the zero vector.
inline DoubleFloat3 normalize(const DoubleFloat3& x) noexcept { return double_float_bare::normalizePair(x); }
inline constexpr double kNormalizeBound = 5.5 + kInverseSquareRootBound + kMultiplyBound;
inline constexpr double kNormalizeShaderBound = 5.5 + kInverseSquareRootShaderBound + kMultiplyBound;

}  // namespace terrane

#pragma once
// Included by every file whose results reach a tile: refuses to compile where the compiler may change the value of an
// expression (fast_math_refused.sh tries it). Some of GCC's options and all but two of Clang's set no macro, and nor
// does contraction: contraction_probe_test sees what they do.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error "Terrane's tiles must be the same bytes everywhere: never build with value-changing floating-point options"
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error "Terrane needs float and double to be evaluated in their own precision (FLT_EVAL_METHOD 0)"
#endif

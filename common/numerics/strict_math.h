#pragma once
// Included by every file whose results reach a tile: refuses to compile where the compiler may change the value of an
// expression. (Contraction is proven off by a test, since no macro tells.)
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "Terrane's tiles must be the same bytes everywhere: never build with value-changing floating-point options"
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0
#error "Terrane needs float and double to be evaluated in their own precision (FLT_EVAL_METHOD 0)"
#endif

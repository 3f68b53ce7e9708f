// The loops of operation_loops.h: part of every build of them. Included with kOperationLoop naming the entry.
// Everything is of this translation unit alone: what is built for a newer CPU must not be linked into anything else.

#include "common/numerics/strict_math.h"
#include "tests/accuracy/double_float/operation_loops.h"

namespace terrane::accuracy {
namespace {

struct Pair {
  Pair(float high, float low) : hi(high), lo(low) {}
  float hi, lo;
};

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"

namespace split {
inline float inverseRoot(float x) { return 1.0f / __builtin_sqrtf(x); }
#define sqrt __builtin_sqrtf
#define REAL float
#define PAIR Pair
#define PRECISE
#define FUNCTION inline
#define INVERSE_ROOT inverseRoot
#include "common/numerics/double_float_operations.glsl"
}  // namespace split

#ifdef __FMA__
namespace fused {
using split::inverseRoot;
using split::splitFloat;
inline Pair twoProd(float a, float b) {
  const float product = a * b;
  return {product, __builtin_fmaf(a, b, -product)};
}
#define OWN_SPLIT
#define OWN_PROD
#include "common/numerics/double_float_operations.glsl"
#undef OWN_SPLIT
#undef OWN_PROD
}  // namespace fused
#endif
#undef sqrt
#undef REAL
#undef PAIR
#undef PRECISE
#undef FUNCTION
#undef INVERSE_ROOT

#pragma GCC diagnostic pop

inline Pair asPair(float value) { return {value, 0.0f}; }

template <class Function>
void pairLoop(const OperandArrays& arrays, std::size_t count, Function function) {
  const float *__restrict xHi = arrays.xHi, *__restrict xLo = arrays.xLo, *__restrict yHi = arrays.yHi,
                         *__restrict yLo = arrays.yLo;
  float* __restrict outHi = arrays.outHi, * __restrict outLo = arrays.outLo;
  for (std::size_t i = 0; i < count; ++i) {
    const Pair result = function(Pair(xHi[i], xLo[i]), Pair(yHi[i], yLo[i]));
    outHi[i] = result.hi;
    outLo[i] = result.lo;
  }
}

template <class Function>
void floatLoop(const OperandArrays& arrays, std::size_t count, Function function) {
  const float* __restrict x = arrays.xHi, * __restrict y = arrays.yHi;
  float* __restrict out = arrays.outHi;
  for (std::size_t i = 0; i < count; ++i) out[i] = function(x[i], y[i]);
}

template <class Function>
void doubleLoop(const OperandArrays& arrays, std::size_t count, Function function) {
  const double* __restrict x = arrays.x, * __restrict y = arrays.y;
  double* __restrict out = arrays.out;
  for (std::size_t i = 0; i < count; ++i) out[i] = function(x[i], y[i]);
}

inline float rootOf(float x) { return __builtin_sqrtf(x); }
inline double rootOf(double x) { return __builtin_sqrt(x); }

#define PAIR_LOOP(SPACE, EXPRESSION)                                                    \
  [](const OperandArrays& arrays, std::size_t count) {                                  \
    pairLoop(arrays, count, [](const Pair& x, [[maybe_unused]] const Pair& y) -> Pair { \
      using namespace SPACE; /* NOLINT: the operations of one form */                   \
      return EXPRESSION;                                                                \
    });                                                                                 \
  }
#define PLAIN_LOOP(LOOP, REAL_TYPE, EXPRESSION)                                                \
  [](const OperandArrays& arrays, std::size_t count) {                                         \
    LOOP(arrays, count, [](REAL_TYPE x, [[maybe_unused]] REAL_TYPE y) { return EXPRESSION; }); \
  }
#ifdef __FMA__
#define FUSED_LOOP(EXPRESSION) PAIR_LOOP(fused, EXPRESSION)
#else
#define FUSED_LOOP(EXPRESSION) nullptr
#endif
#define OPERATION(PAIRS, PLAIN)                                                                          \
  {                                                                                                      \
    PLAIN_LOOP(floatLoop, float, PLAIN), PLAIN_LOOP(doubleLoop, double, PLAIN), PAIR_LOOP(split, PAIRS), \
        FUSED_LOOP(PAIRS)                                                                                \
  }

/// In the order of test::pairOperations().
const OperationLoop kLoops[][4] = {
    OPERATION(addFloat(x, y.hi), x + y),
    OPERATION(addPair(x, y), x + y),
    OPERATION(asPair(addPairToFloat(x, y)), x + y),
    OPERATION(asPair(subtractPairToFloat(x, y)), x - y),
    OPERATION(multiplyFloat(x, y.hi), x* y),
    OPERATION(multiplyPair(x, y), x* y),
    OPERATION(divideFloat(x, y.hi), x / y),
    OPERATION(dividePair(x, y), x / y),
    OPERATION(squareRootPair(x), rootOf(x)),
    OPERATION(inverseSquareRootPair(x), 1 / rootOf(x)),
};

}  // namespace

OperationLoop kOperationLoop(int operation, NumberKind kind) { return kLoops[operation][static_cast<int>(kind)]; }

}  // namespace terrane::accuracy

#pragma once
// Loops that do one operation for many operands, in arrays, so that a compiler may use the whole vector: float, double,
// and pairs with the product's error by Dekker's split or by a fused multiply-add. Built for the oldest x86-64 and for
// AVX2.

#include <cstddef>

namespace terrane::accuracy {

enum class NumberKind { Float, Double, Pairs, PairsByFma };

struct OperandArrays {
  const float *xHi, *xLo, *yHi, *yLo;
  const double *x, *y;
  float *outHi, *outLo;
  double* out;
};

using OperationLoop = void (*)(const OperandArrays&, std::size_t count);

/// operation: index in test::pairOperations(). Null where this build has no such loop.
OperationLoop operationLoopDefault(int operation, NumberKind kind);
OperationLoop operationLoopV3(int operation, NumberKind kind);  ///< run only where the CPU has AVX2 and FMA

}  // namespace terrane::accuracy

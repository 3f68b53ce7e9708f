#pragma once
// What every implementation of double-float must pass, the CPU's and shaders' alike: a table of the operations with
// their proven bounds, and a search for each one's worst error against MPFR. Deterministic for a seed.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/numerics/double_float3.h"
#include "tests/support/double_float_operands.h"

namespace terrane::test {

enum class OperandKind : std::uint8_t {
  Sum,         ///< y anywhere between the last bit of x and 8 x; a quarter of them nearly -x
  Difference,  ///< the same with y nearly x
  Product,     ///< within a binade: a product's error does not depend on exponents
  Positive,    ///< x > 0 within two binades, odd and even exponents
};

struct PairOperation {
  const char* name = "";  ///< in double_float_operations.glsl
  const char* title = "";
  const char* source = "";
  int floatOperations = 0;
  double bound = 0;                 ///< proven, in units
  double expected = 0;              ///< a search that does not come near this is too easy to prove anything
  double unit = kFloatUnitSquared;  ///< kFloatUnit where the result is a float
  double shaderBound = 0;           ///< where the hardware's division and roots are only what the language promises
  OperandKind operands = OperandKind::Sum;
  bool yIsFloat = false;
  HighPrecision (*exact)(const HighPrecision& x, const HighPrecision& y) = nullptr;
  DoubleFloat (*bare)(const DoubleFloat& x, const DoubleFloat& y) = nullptr;
  DoubleFloat3 (*bareInThrees)(const DoubleFloat3& x, const DoubleFloat3& y) = nullptr;
  DoubleFloat (*settled)(const DoubleFloat& x, const DoubleFloat& y) = nullptr;  ///< double_float.h's
  const char* shader = "";  ///< an expression of x and y in GLSL that gives a pair
};

std::span<const PairOperation> pairOperations();

struct OperandPair {
  DoubleFloat x, y;
};

/// An implementation: results of one operation for many operands.
using Evaluate = std::function<std::vector<DoubleFloat>(const PairOperation&, std::span<const OperandPair>)>;
Evaluate bareOnCpu();
Evaluate settledOnCpu();
/// In lanes of glm::vec3; the operands come in threes.
Evaluate bareOnCpuInThrees();

struct WorstFound {
  double units = 0;
  OperandPair at;
};

/// Random operands first, awkward ones among them; then ever smaller changes to the worst of them.
WorstFound searchWorst(const PairOperation& operation, const Evaluate& evaluate, std::uint64_t seed,
                       std::size_t samples);

/// Relative error in the operation's unit; NaN is infinite.
double errorUnits(const PairOperation& operation, const OperandPair& operands, const DoubleFloat& result);

}  // namespace terrane::test

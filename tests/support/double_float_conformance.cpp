#include "tests/support/double_float_conformance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace terrane::test {
namespace {

namespace bare = double_float_bare;
using DF = const DoubleFloat&;
using HP = const HighPrecision&;

HighPrecision sum(HP x, HP y) { return x + y; }
HighPrecision difference(HP x, HP y) { return x - y; }
HighPrecision product(HP x, HP y) { return x * y; }
HighPrecision quotient(HP x, HP y) { return x / y; }
HighPrecision root(HP x, HP) { return sqrt(x); }
HighPrecision inverseRoot(HP x, HP) { return 1 / sqrt(x); }

DoubleFloat asPair(float x) { return {x, 0.0f}; }
DoubleFloat3 asPair(const glm::vec3& x) { return {x, glm::vec3(0.0f)}; }

/// A generic function serves floats and threes alike.
struct Adder {
  std::vector<PairOperation>& all;

  template <class Bare, class Settled>
  void operator()(const PairOperation& described, Bare bareForm, Settled settledForm) const {
    all.push_back(described);
    all.back().bare = bareForm;
    all.back().bareInThrees = bareForm;
    all.back().settled = settledForm;
  }
};

void addSums(std::vector<PairOperation>& all) {
  const Adder operation{all};
  operation(
      {.name = "addFloat",
       .title = "pair + float",
       .source = "JMP17 algorithm 4",
       .floatOperations = 10,
       .bound = kAddFloatBound,
       .expected = 1.99,
       .operands = OperandKind::Sum,
       .yIsFloat = true,
       .exact = sum,
       .shader = "addFloat(x, y.hi)"},
      [](const auto& x, const auto& y) { return bare::addFloat(x, y.hi); }, [](DF x, DF y) { return add(x, y.hi); });
  operation(
      {.name = "addPair",
       .title = "pair + pair",
       .source = "JMP17 algorithm 6",
       .floatOperations = 20,
       .bound = kAddBound,
       .expected = 2.4,
       .operands = OperandKind::Sum,
       .exact = sum,
       .shader = "addPair(x, y)"},
      [](const auto& x, const auto& y) { return bare::addPair(x, y); }, [](DF x, DF y) { return add(x, y); });
  operation(
      {.name = "addPairToFloat",
       .title = "pair + pair, as float",
       .source = "JMP17 algorithm 6, demoted",
       .floatOperations = 18,
       .bound = kSubtractAndDemoteBound,
       .expected = 0.99,
       .unit = kFloatUnit,
       .operands = OperandKind::Sum,
       .exact = sum,
       .shader = "asPair(addPairToFloat(x, y))"},
      [](const auto& x, const auto& y) { return asPair(bare::addPairToFloat(x, y)); },
      [](DF x, DF y) { return asPair(addAndDemote(x, y)); });
  operation(
      {.name = "subtractPairToFloat",
       .title = "pair − pair, as float",
       .source = "JMP17 algorithm 6, demoted",
       .floatOperations = 18,
       .bound = kSubtractAndDemoteBound,
       .expected = 0.99,
       .unit = kFloatUnit,
       .operands = OperandKind::Difference,
       .exact = difference,
       .shader = "asPair(subtractPairToFloat(x, y))"},
      [](const auto& x, const auto& y) { return asPair(bare::subtractPairToFloat(x, y)); },
      [](DF x, DF y) { return asPair(subtractAndDemote(x, y)); });
}

void addProducts(std::vector<PairOperation>& all) {
  const Adder operation{all};
  operation(
      {.name = "multiplyFloat",
       .title = "pair × float",
       .source = "JMP17 algorithm 7",
       .floatOperations = 25,
       .bound = kMultiplyFloatBound,
       .expected = 1.49,
       .operands = OperandKind::Product,
       .yIsFloat = true,
       .exact = product,
       .shader = "multiplyFloat(x, y.hi)"},
      [](const auto& x, const auto& y) { return bare::multiplyFloat(x, y.hi); },
      [](DF x, DF y) { return multiply(x, y.hi); });
  operation(
      {.name = "multiplyPair",
       .title = "pair × pair",
       .source = "JMP17 algorithm 10, MR22",
       .floatOperations = 24,
       .bound = kMultiplyBound,
       .expected = 4.4,
       .operands = OperandKind::Product,
       .exact = product,
       .shader = "multiplyPair(x, y)"},
      [](const auto& x, const auto& y) { return bare::multiplyPair(x, y); }, [](DF x, DF y) { return multiply(x, y); });
  operation(
      {.name = "divideFloat",
       .title = "pair ÷ float",
       .source = "JMP17 algorithm 15",
       .floatOperations = 25,
       .bound = kDivideFloatBound,
       .expected = 2.8,
       .shaderBound = 55,
       .operands = OperandKind::Product,
       .yIsFloat = true,
       .exact = quotient,
       .shader = "divideFloat(x, y.hi)"},
      [](const auto& x, const auto& y) { return bare::divideFloat(x, y.hi); },
      [](DF x, DF y) { return divide(x, y.hi); });
  operation(
      {.name = "dividePair",
       .title = "pair ÷ pair",
       .source = "JMP17 algorithm 17",
       .floatOperations = 33,
       .bound = kDivideBound,
       .expected = 7.4,
       .shaderBound = 55,
       .operands = OperandKind::Product,
       .exact = quotient,
       .shader = "dividePair(x, y)"},
      [](const auto& x, const auto& y) { return bare::dividePair(x, y); }, [](DF x, DF y) { return divide(x, y); });
}

void addRoots(std::vector<PairOperation>& all) {
  const Adder operation{all};
  operation(
      {.name = "squareRootPair",
       .title = "√ pair",
       .source = "LLMPR23 SQRTDWtoDW",
       .floatOperations = 26,
       .bound = kSquareRootBound,
       .expected = 3.1,
       .shaderBound = 110,
       .operands = OperandKind::Positive,
       .exact = root,
       .shader = "squareRootPair(x)"},
      [](const auto& x, const auto&) { return bare::squareRootPair(x); }, [](DF x, DF) { return squareRoot(x); });
  operation(
      {.name = "inverseSquareRootPair",
       .title = "1/√ pair",
       .source = "one Newton step, own bound",
       .floatOperations = 49,
       .bound = kInverseSquareRootBound,
       .expected = 6.0,
       .shaderBound = kInverseSquareRootShaderBound,
       .operands = OperandKind::Positive,
       .exact = inverseRoot,
       .shader = "inverseSquareRootPair(x)"},
      [](const auto& x, const auto&) { return bare::inverseSquareRootPair(x); },
      [](DF x, DF) { return inverseSquareRoot(x); });
}

/// The same magnitude but for the last bits, which is where sums cancel.
DoubleFloat nearly(const DoubleFloat& x, DoubleFloatOperands& operands) {
  float hi = x.hi;
  for (std::uint64_t steps = operands.bits(2); steps > 0; --steps) hi = std::nextafter(hi, 0.0f);
  const int exponent = std::ilogb(x.hi);
  return bare::twoSum(hi, operands.single(exponent - 46, exponent - 25));
}

OperandPair draw(const PairOperation& operation, DoubleFloatOperands& operands) {
  OperandPair pair;
  switch (operation.operands) {
    case OperandKind::Sum:
    case OperandKind::Difference:
      pair.x = operands.pair(-2, 3);
      pair.y = operands.pair(operands.bits(1) != 0 ? -2 : -26, 3);
      if (operands.bits(2) == 0) pair.y = nearly(pair.x, operands);
      if (operands.bits(2) == 0 || operation.operands == OperandKind::Difference) {
        const bool alike = (pair.x.hi < 0) == (pair.y.hi < 0);
        if (alike == (operation.operands == OperandKind::Sum)) pair.y = -pair.y;
      }
      break;
    case OperandKind::Product:
      pair.x = operands.pair(0, 1);
      pair.y = operands.pair(0, 1);
      break;
    case OperandKind::Positive:
      pair.x = operands.pair(0, 1);
      if (pair.x.hi < 0) pair.x = -pair.x;
      break;
  }
  if (operation.yIsFloat) pair.y.lo = 0;
  return pair;
}

/// A number whose words are moved by some units in the last place.
DoubleFloat changed(const DoubleFloat& x, DoubleFloatOperands& operands) {
  const auto moved = [&](float value, int bits) {
    if (value == 0) return value;
    const float ulp = std::ldexp(1.0f, std::ilogb(value) - 23);
    const auto by = static_cast<float>(static_cast<std::int64_t>(operands.bits(bits + 1)) - (std::int64_t{1} << bits));
    return value + by * ulp;
  };
  constexpr std::array<int, 4> kBits{0, 2, 12, 22};  // from next to nothing to another number of that size
  const float hi = moved(x.hi, kBits[operands.bits(2)]);
  const float lo = moved(x.lo, kBits[operands.bits(2)]);
  return bare::twoSum(hi, lo);
}

OperandPair changed(const PairOperation& operation, const OperandPair& from, DoubleFloatOperands& operands) {
  OperandPair pair = from;
  const auto which = operands.bits(2);
  if (which != 0) pair.x = changed(pair.x, operands);
  if (which != 1) pair.y = changed(pair.y, operands);
  if (operation.yIsFloat) pair.y.lo = 0;
  return pair;
}

/// The worst few so far, the very worst first.
class Leaders {
 public:
  void offer(const WorstFound& found) {
    if (list_.size() == kCount && found.units <= list_.back().units) return;
    list_.insert(std::ranges::upper_bound(list_, found.units, std::ranges::greater(), &WorstFound::units), found);
    if (list_.size() > kCount) list_.pop_back();
  }
  const std::vector<WorstFound>& list() const { return list_; }

 private:
  static constexpr std::size_t kCount = 32;
  std::vector<WorstFound> list_;
};

}  // namespace

std::span<const PairOperation> pairOperations() {
  static const std::vector<PairOperation> all = [] {
    std::vector<PairOperation> made;
    addSums(made);
    addProducts(made);
    addRoots(made);
    return made;
  }();
  return all;
}

Evaluate bareOnCpu() {
  return [](const PairOperation& operation, std::span<const OperandPair> operands) {
    std::vector<DoubleFloat> results;
    results.reserve(operands.size());
    for (const OperandPair& pair : operands) results.push_back(operation.bare(pair.x, pair.y));
    return results;
  };
}

Evaluate settledOnCpu() {
  return [](const PairOperation& operation, std::span<const OperandPair> operands) {
    std::vector<DoubleFloat> results;
    results.reserve(operands.size());
    for (const OperandPair& pair : operands) results.push_back(operation.settled(pair.x, pair.y));
    return results;
  };
}

Evaluate bareOnCpuInThrees() {
  return [](const PairOperation& operation, std::span<const OperandPair> operands) {
    std::vector<DoubleFloat> results;
    for (std::size_t i = 0; i + 2 < operands.size(); i += 3) {
      DoubleFloat3 x, y;
      for (std::size_t lane = 0; lane < 3; ++lane) {
        const auto axis = static_cast<int>(lane);
        const OperandPair& pair = operands[i + lane];
        x.hi[axis] = pair.x.hi, x.lo[axis] = pair.x.lo;
        y.hi[axis] = pair.y.hi, y.lo[axis] = pair.y.lo;
      }
      const DoubleFloat3 result = operation.bareInThrees(x, y);
      for (int axis = 0; axis < 3; ++axis) results.emplace_back(result.hi[axis], result.lo[axis]);
    }
    return results;
  };
}

double errorUnits(const PairOperation& operation, const OperandPair& operands, const DoubleFloat& result) {
  const HighPrecision reference = operation.exact(exact(operands.x), exact(operands.y));
  if (reference == 0) return result.hi == 0 && result.lo == 0 ? 0 : std::numeric_limits<double>::infinity();
  const double error = std::fabs(static_cast<double>(HighPrecision((exact(result) - reference) / reference)));
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error / operation.unit;
}

WorstFound searchWorst(const PairOperation& operation, const Evaluate& evaluate, std::uint64_t seed,
                       std::size_t samples) {
  constexpr std::size_t kBatch = 3 * 1024;
  DoubleFloatOperands operands(seed);
  Leaders leaders;
  std::vector<OperandPair> batch(kBatch);
  for (std::size_t done = 0; done < samples; done += kBatch) {
    const bool exploring = done < samples / 2 || leaders.list().empty();
    for (OperandPair& pair : batch) {
      const auto leader = exploring ? 0 : operands.bits(20) % leaders.list().size();
      pair = exploring ? draw(operation, operands) : changed(operation, leaders.list()[leader].at, operands);
    }
    const std::vector<DoubleFloat> results = evaluate(operation, batch);
    for (std::size_t i = 0; i < batch.size(); ++i)
      leaders.offer({errorUnits(operation, batch[i], results[i]), batch[i]});
  }
  return leaders.list().front();
}

}  // namespace terrane::test

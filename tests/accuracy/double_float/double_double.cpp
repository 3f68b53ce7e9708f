#include "tests/accuracy/double_float/double_double.h"

#include <qd/dd_real.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "tests/support/double_float_operands.h"

namespace terrane::accuracy {
namespace {

using test::HighPrecision;

HighPrecision exact(const dd_real& x) { return HighPrecision(x.x[0]) + HighPrecision(x.x[1]); }

struct Operation {
  std::string_view name;
  dd_real (*run)(const dd_real& x, const dd_real& y);
  HighPrecision (*truth)(const HighPrecision& x, const HighPrecision& y);
  bool sum, yIsDouble;
};

using DD = const dd_real&;
using HP = const HighPrecision&;

const std::array<Operation, 8> kOperations{{
    {"addFloat", [](DD x, DD y) { return x + y.x[0]; }, [](HP x, HP y) { return HighPrecision(x + y); }, true, true},
    {"addPair", [](DD x, DD y) { return x + y; }, [](HP x, HP y) { return HighPrecision(x + y); }, true, false},
    {"multiplyFloat", [](DD x, DD y) { return x * y.x[0]; }, [](HP x, HP y) { return HighPrecision(x * y); }, false,
     true},
    {"multiplyPair", [](DD x, DD y) { return x * y; }, [](HP x, HP y) { return HighPrecision(x * y); }, false, false},
    {"divideFloat", [](DD x, DD y) { return x / y.x[0]; }, [](HP x, HP y) { return HighPrecision(x / y); }, false,
     true},
    {"dividePair", [](DD x, DD y) { return x / y; }, [](HP x, HP y) { return HighPrecision(x / y); }, false, false},
    {"squareRootPair", [](DD x, DD) { return sqrt(x); }, [](HP x, HP) { return HighPrecision(sqrt(x)); }, false, false},
    {"inverseSquareRootPair", [](DD x, DD) { return 1.0 / sqrt(x); },
     [](HP x, HP) { return HighPrecision(1 / sqrt(x)); }, false, false},
}};

const Operation* find(std::string_view name) {
  const auto* found = std::ranges::find(kOperations, name, &Operation::name);
  return found == kOperations.end() ? nullptr : found;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t bits(int count) { return engine_() >> (64 - count); }
  dd_real positive() {
    const double high = 1 + std::ldexp(static_cast<double>(bits(52)), -52);
    return normalised(high, std::ldexp(static_cast<double>(bits(53)) - 0x1p52, -106));
  }
  /// The same but for the last bits.
  dd_real near(const dd_real& x) {
    return normalised(x.x[0], std::ldexp(static_cast<double>(bits(53)) - 0x1p52, -106 - static_cast<int>(bits(4))));
  }

 private:
  static dd_real normalised(double high, double low) {
    const double sum = high + low;
    return {sum, low - (sum - high)};
  }
  std::mt19937_64 engine_;
};

}  // namespace

Work doubleDoubleWork(std::string_view name) {
  const Operation* operation = find(name);
  if (operation == nullptr) return {};
  constexpr std::size_t kCount = 1024;
  const auto x = std::make_shared<std::vector<dd_real>>(), y = std::make_shared<std::vector<dd_real>>(),
             out = std::make_shared<std::vector<dd_real>>(kCount);
  Random random(1);
  for (std::size_t i = 0; i < kCount; ++i) {
    x->push_back(random.positive());
    y->push_back(random.positive());
  }
  // Each operation inlined in its own loop, as a user of the library would have it.
  const auto loop = [=](auto function) -> Work {
    return [=](std::size_t count) {
      for (std::size_t done = 0; done < count; done += kCount)
        for (std::size_t i = 0; i < kCount; ++i) (*out)[i] = function((*x)[i], (*y)[i]);
      return out->front().x[0];
    };
  };
  if (name == "addFloat") return loop([](DD a, DD b) { return a + b.x[0]; });
  if (name == "addPair") return loop([](DD a, DD b) { return a + b; });
  if (name == "multiplyFloat") return loop([](DD a, DD b) { return a * b.x[0]; });
  if (name == "multiplyPair") return loop([](DD a, DD b) { return a * b; });
  if (name == "divideFloat") return loop([](DD a, DD b) { return a / b.x[0]; });
  if (name == "dividePair") return loop([](DD a, DD b) { return a / b; });
  return loop(operation->run);
}

double doubleDoubleWorst(std::string_view name, std::uint64_t seed, int samples) {
  const Operation* operation = find(name);
  if (operation == nullptr) return 0;
  Random random(seed);
  double worst = 0;
  for (int i = 0; i < samples; ++i) {
    const dd_real x = random.positive();
    dd_real y = random.bits(2) == 0 ? random.near(x) : random.positive();
    if (operation->sum && random.bits(1) != 0) y = -y;
    if (operation->yIsDouble) y.x[1] = 0;
    const HighPrecision truth = operation->truth(exact(x), exact(y));
    if (truth == 0) continue;
    const double error =
        std::fabs(static_cast<double>(HighPrecision((exact(operation->run(x, y)) - truth) / truth))) * 0x1p106;
    worst = std::max(worst, error);
  }
  return worst;
}

}  // namespace terrane::accuracy

// Every double-float operation: the worst relative error that a search finds, its proven bound, and its time beside
// float's, double's, a fused multiply-add's and libqd's pairs of doubles.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <future>

#include "server/fields/height_field.h"
#include "tests/accuracy/double_float/double_double.h"
#include "tests/accuracy/double_float/operation_loops.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/span.h"
#include "tests/support/double_float_conformance.h"

namespace terrane::accuracy {
namespace {

using test::PairOperation;

constexpr std::size_t kCount = 1024;  // stay in the first-level cache

OperationLoop loopOf(std::size_t operation, NumberKind kind) {
  const auto index = static_cast<int>(operation);
  return simdPathSupported(SimdPath::V3) ? operationLoopV3(index, kind) : operationLoopDefault(index, kind);
}

/// The same values in each type; x is positive, for roots.
class Arrays {
 public:
  explicit Arrays(std::uint64_t seed) {
    test::DoubleFloatOperands operands(seed);
    for (std::size_t i = 0; i < kCount; ++i) {
      DoubleFloat x = operands.pair(-2, 3);
      const DoubleFloat y = operands.pair(-2, 3);
      if (x.hi < 0) x = -x;
      xHi_[i] = x.hi, xLo_[i] = x.lo, yHi_[i] = y.hi, yLo_[i] = y.lo;
      x_[i] = toDouble(x), y_[i] = toDouble(y);
    }
  }
  Work work(OperationLoop loop) {
    return [this, loop](std::size_t count) {
      const OperandArrays arrays{xHi_.data(), xLo_.data(),   yHi_.data(),   yLo_.data(), x_.data(),
                                 y_.data(),   outHi_.data(), outLo_.data(), out_.data()};
      for (std::size_t done = 0; done < count; done += kCount) loop(arrays, kCount);
      return static_cast<double>(outHi_[0]) + out_[0];
    };
  }

 private:
  std::array<float, kCount> xHi_{}, xLo_{}, yHi_{}, yLo_{}, outHi_{}, outLo_{};
  std::array<double, kCount> x_{}, y_{}, out_{};
};

/// In parts of fixed seeds, so that the result does not depend on how many run at once.
double worstFound(const PairOperation& operation, std::uint64_t seed, std::size_t samples) {
  constexpr std::size_t kParts = 4;
  std::vector<std::future<double>> parts;
  for (std::size_t part = 0; part < kParts; ++part)
    parts.push_back(std::async(std::launch::async, [&, part] {
      return test::searchWorst(operation, test::bareOnCpu(), seed + part, samples / kParts).units;
    }));
  double worst = 0;
  for (auto& part : parts) worst = std::max(worst, part.get());
  return worst;
}

/// Others have nothing that a fused multiply-add could do.
bool hasProducts(const PairOperation& operation) {
  return operation.operands == test::OperandKind::Product || operation.operands == test::OperandKind::Positive;
}

/// Nanoseconds; 0 where there is none.
struct Times {
  double asFloat = 0, asDouble = 0, pairs = 0, fused = 0, doubleDouble = 0;
};

std::vector<Times> timesOf(Arrays& arrays, const Settings& settings) {
  const auto all = test::pairOperations();
  std::vector<Times> times(all.size());
  std::vector<Work> ways;
  std::vector<double*> places;
  const auto add = [&](Work work, double& place) {
    if (!work) return;
    ways.push_back(std::move(work));
    places.push_back(&place);
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto loop = [&](NumberKind kind) {
      return loopOf(i, kind) != nullptr ? arrays.work(loopOf(i, kind)) : Work{};
    };
    add(loop(NumberKind::Float), times[i].asFloat);
    add(loop(NumberKind::Double), times[i].asDouble);
    add(loop(NumberKind::Pairs), times[i].pairs);
    if (hasProducts(all[i])) add(loop(NumberKind::PairsByFma), times[i].fused);
    add(doubleDoubleWork(all[i].name), times[i].doubleDouble);
  }
  const std::vector<double> taken =
      nanosecondsPerItem(ways, kCount * (settings.quick ? 8u : 64u), settings.quick ? 7 : 25);
  for (std::size_t i = 0; i < taken.size(); ++i) *places[i] = taken[i];
  return times;
}

struct Table {
  Report report;
  double libraryWorstSum = 0;
  Span nearness;               ///< worst found, % of the bound
  Span pairs, fused, library;  ///< time over double's
};

void addRows(Table& table, const PairOperation& operation, const Times& times, const Settings& settings) {
  const bool demoted = operation.unit == kFloatUnit;
  const double worst = worstFound(operation, settings.seed, settings.quick ? 20'000 : 10'000'000);
  const auto row = [&](const char* number, const std::string& source, const std::string& operations,
                       const std::string& bound, const std::string& found, double relative, double time) {
    table.report.rows.push_back({std::string(operation.title), std::string(number), source, operations, bound, found,
                                 relative, time, time / times.asFloat, time / times.asDouble});
  };
  const auto inUnits = [&](double value) { return fmt::format("{:.4g}{}", value, demoted ? " u" : " u²"); };
  row("pair of floats", operation.source, std::to_string(operation.floatOperations), inUnits(operation.bound),
      inUnits(worst), worst * operation.unit, times.pairs);
  table.pairs.include(times.pairs / times.asDouble);
  if (times.fused > 0) {
    row("pair of floats, by FMA", operation.source, "fewer", inUnits(operation.bound), inUnits(worst),
        worst * operation.unit, times.fused);
    table.fused.include(times.fused / times.asDouble);
  }
  if (times.doubleDouble > 0) {
    const double library = doubleDoubleWorst(operation.name, settings.seed, settings.quick ? 10'000 : 300'000);
    row("pair of doubles (libqd)", "libqd's own", "-", "none stated", fmt::format("{:.4g} u²", library),
        library * 0x1p-106, times.doubleDouble);
    table.library.include(times.doubleDouble / times.asDouble);
    if (std::string_view(operation.name) == "addPair") table.libraryWorstSum = library;
  }
  // Correctly rounded by IEEE 754; 1/sqrt is a root and a quotient.
  const bool rounded = std::string_view(operation.name) != "inverseSquareRootPair";
  const char *operations = rounded ? "1" : "2", *bound = rounded ? "1 u" : "1.5 u";
  const double units = rounded ? 1 : 1.5;
  row("float", "hardware", operations, bound, "-", units * kFloatUnit, times.asFloat);
  row("double", "hardware", operations, bound, "-", units * 0x1p-53, times.asDouble);
  table.nearness.include(100 * worst / operation.bound);
}

std::vector<std::string> findings(const Table& table) {
  std::string times =
      fmt::format("In vectors on this CPU pairs of floats take {} times double's time", table.pairs.text());
  if (table.fused.most() > 0)
    times += fmt::format(", products, quotients and roots {} by a fused multiply-add", table.fused.text());
  return {
      fmt::format(
          "No error found exceeds its proven bound. The search closes in on the worst operands: it comes to {} % "
          "of the bounds; the least near are those of pair ÷ pair and 1/√ pair, whose bounds no one has shown "
          "to be sharp.",
          table.nearness.text()),
      times + fmt::format(", for 5 bits less; libqd's pairs of doubles, as a program for any x86-64 has them, {}. No "
                          "shading language promises that its fma() is fused, and llvmpipe's is not: shaders take "
                          "Dekker's split.",
                          table.library.text()),
      fmt::format("libqd adds by the sloppy algorithm unless it is built otherwise: for operands of opposite signs "
                  "it was off by {:.2g} u² of its own, where the accurate sum stays below 3.",
                  table.libraryWorstSum)};
}

Report run(const Settings& settings, Progress& progress) {
  Arrays arrays(settings.seed);
  const std::vector<Times> times = timesOf(arrays, settings);
  Table table;
  table.report.columns = {{"operation", "operation"},
                          {"number", "numbers"},
                          {"source", "algorithm"},
                          {"floatOperations", "operations"},
                          {"bound", "proven bound"},
                          {"worst", "worst error found"},
                          {"worstRelative", "worst error, relative"},
                          {"timeNs", "time, ns"},
                          {"timeRatioToFloat", "time / float's"},
                          {"timeRatioToDouble", "time / double's"}};
  const auto all = test::pairOperations();
  for (std::size_t i = 0; i < all.size(); ++i) {
    addRows(table, all[i], times[i], settings);
    progress.at(static_cast<double>(i + 1) / static_cast<double>(all.size()));
  }
  table.report.plots = {
      {"Error over time, an operation a point", "timeNs", "worstRelative", "number", true, true, false}};
  table.report.findings = findings(table);
  return table.report;
}

const Registration kRegistered({50, "double-float", "Double-float operations",
                                "What does each operation on pairs of floats cost, and how exact is it?", run});

}  // namespace
}  // namespace terrane::accuracy

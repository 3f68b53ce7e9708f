// The project's own tangent and arc tangent against the C library's: error against MPFR, time, and whether a last bit
// depends on the CPU. The latter by a child process in which glibc may not use FMA.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/own_functions.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/support/child_process.h"
#include "tests/support/double_float_operands.h"

namespace terrane::accuracy {
namespace {

using test::HighPrecision;

HighPrecision exactValue(const FunctionOfOne& f, double at) {
  static const HighPrecision kExactQuarterPi = atan(HighPrecision(1));
  const HighPrecision x(at);
  const std::string_view name = f.function;
  if (name.starts_with("tan")) return tan(HighPrecision(x * kExactQuarterPi));
  if (name.starts_with("atan")) return HighPrecision(atan(x) / kExactQuarterPi);
  if (name.starts_with("sin")) return sin(x);
  if (name.starts_with("cos")) return cos(x);
  if (name.starts_with("exp")) return exp(x);
  if (name.starts_with("log")) return log(x);
  return pow(x, HighPrecision(0.52));
}

/// In units of the last place of the exact value's double.
double errorUlp(double given, const HighPrecision& exact) {
  const auto nearest = exact.convert_to<double>();
  if (nearest == 0) return given == 0 ? 0 : INFINITY;
  const double ulp = std::ldexp(1.0, std::ilogb(nearest) - 52);
  return std::fabs(HighPrecision((HighPrecision(given) - exact) / ulp).convert_to<double>());
}

/// All functions' values where glibc has no FMA; empty where this cannot be tried.
std::optional<std::vector<double>> valuesWithoutFma(std::size_t count, std::uint64_t seed) {
  std::error_code failure;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", failure);
  const auto program = self.parent_path() / "terrane-function-values";
  if (failure || !std::filesystem::exists(program, failure)) return std::nullopt;
  testing_support::ChildProcess child({"/usr/bin/env", "GLIBC_TUNABLES=" + std::string(testing_support::kWithoutFma),
                                       program.string(), std::to_string(count), std::to_string(seed)});
  if (child.wait(std::chrono::seconds(60)) != 0) return std::nullopt;
  std::vector<double> values;
  std::istringstream lines(child.output());
  for (std::string line; std::getline(lines, line);) values.push_back(std::strtod(line.c_str(), nullptr));
  if (values.size() != count * kFunctions.size()) return std::nullopt;
  return values;
}

struct Outcome {
  double worstUlp = 0;
  std::optional<std::int64_t> changed;  ///< results with other bits without FMA
};

Outcome outcomeOf(const FunctionOfOne& f, const std::vector<double>& arguments, std::size_t measured,
                  const double* withoutFma) {
  Outcome outcome;
  for (std::size_t i = 0; i < measured; ++i)
    outcome.worstUlp = std::max(outcome.worstUlp, errorUlp(f.value(arguments[i]), exactValue(f, arguments[i])));
  if (withoutFma == nullptr) return outcome;
  outcome.changed = 0;
  for (std::size_t i = 0; i < arguments.size(); ++i)
    if (std::bit_cast<std::uint64_t>(f.value(arguments[i])) != std::bit_cast<std::uint64_t>(withoutFma[i]))
      ++*outcome.changed;
  return outcome;
}

std::vector<double> timesNs(const Settings& settings, const std::vector<std::vector<double>>& arguments) {
  std::vector<Work> ways;
  for (std::size_t f = 0; f < kFunctions.size(); ++f)
    ways.push_back([&x = arguments[f], value = kFunctions[f].value](std::size_t count) {
      double sum = 0;
      for (std::size_t i = 0; i < count; ++i) sum += value(x[i % x.size()]);
      return sum;
    });
  return nanosecondsPerItem(ways, 4096, settings.quick ? 9 : 101);
}

std::vector<std::string> findingsFrom(const std::vector<Outcome>& outcomes, const std::vector<double>& times,
                                      std::size_t count) {
  std::vector<std::string> findings;
  std::string changed;
  std::int64_t changedOwn = 0;
  bool tried = true;
  for (std::size_t f = 0; f < kFunctions.size(); ++f) {
    const FunctionOfOne& function = kFunctions[f];
    const auto own = static_cast<std::size_t>(std::max(function.own, 0));
    tried = tried && outcomes[f].changed;
    if (function.own >= 0 && own == f) {
      changedOwn += outcomes[f].changed.value_or(0);
      continue;
    }
    if (outcomes[f].changed.value_or(0) > 0)
      changed += fmt::format("{}{} {:.2g} %", changed.empty() ? "" : ", ", function.function,
                             100 * static_cast<double>(*outcomes[f].changed) / static_cast<double>(count));
    if (function.own >= 0)
      findings.push_back(
          fmt::format("{}: worst error found {:.2f} ulp for the project's own polynomial, {:.2f} ulp with "
                      "the C library, whose time is {:.2f} of the own one's.",
                      function.function, outcomes[own].worstUlp, outcomes[f].worstUlp, times[f] / times[own]));
  }
  const FunctionOfOne &own = kFunctions[0], &library = kFunctions[1];
  findings.push_back(
      fmt::format("At 1, where the faces of the cube meet, tan(x pi/4) is off by {:.2g} in the own "
                  "polynomial and by {:.2g} with the C library.",
                  std::fabs(own.value(1) - 1), std::fabs(library.value(1) - 1)));
  if (tried && changed.empty())
    findings.push_back(
        "Asked to do without FMA, the C library gave the same bits: this one makes no difference, or cannot be asked.");
  if (tried && !changed.empty())
    findings.push_back(fmt::format(
        "In a process where the C library may not use FMA, as on an older CPU, other bits came from it for "
        "{}; from the own functions {}. A tile must be the same bytes everywhere, so it takes the own ones.",
        changed, changedOwn));
  return findings;
}

Report run(const Settings& settings, Progress& progress) {
  const std::size_t count = settings.quick ? 4096 : 65536, measured = settings.quick ? 512 : 8192;
  std::vector<std::vector<double>> arguments;
  for (const FunctionOfOne& f : kFunctions) arguments.push_back(argumentsOf(f, count, settings.seed));
  const std::vector<double> times = timesNs(settings, arguments);
  const auto withoutFma = valuesWithoutFma(count, settings.seed);
  progress.at(0.2);

  Report report;
  report.columns = {{"function", "function"},         {"range", "x"},
                    {"worstUlp", "worst error, ulp"}, {"changed", fmt::format("other bits without FMA, of {}", count)},
                    {"timeNs", "time, ns a value"},   {"timeRatio", "time / that of own"}};
  std::vector<Outcome> outcomes;
  for (std::size_t f = 0; f < kFunctions.size(); ++f) {
    const double* other = withoutFma ? withoutFma->data() + f * count : nullptr;
    outcomes.push_back(outcomeOf(kFunctions[f], arguments[f], measured, other));
    const Outcome& o = outcomes.back();
    const int own = kFunctions[f].own;
    report.rows.push_back(
        {fmt::format("{} {}", kFunctions[f].by, kFunctions[f].function), std::string(kFunctions[f].range), o.worstUlp,
         o.changed ? Value(*o.changed) : Value(std::string("not tried")), times[f],
         own < 0 ? Value(std::string("no own")) : Value(times[f] / times[static_cast<std::size_t>(own)])});
    progress.at(0.2 + 0.8 * static_cast<double>(f + 1) / kFunctions.size());
  }
  report.plots = {{"Error over time", "timeNs", "worstUlp", "function", false, false}};
  report.findings = findingsFrom(outcomes, times, count);
  return report;
}

const Registration kRegistered({76, "own-functions", "Own functions against the C library's",
                                "How exact and how fast are they, and whose last bit depends on the CPU?", run});

}  // namespace
}  // namespace terrane::accuracy

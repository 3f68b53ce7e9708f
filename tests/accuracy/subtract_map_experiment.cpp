// The three-operation subtraction of pairs, (x.hi - y.hi) + (x.lo - y.lo) as a float: where exactly it fails, by the
// distance of the operands. Placing a vertex relative to a camera is this subtraction.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/numerics/double_float.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/support/double_float_operands.h"

namespace terrane::accuracy {
namespace {

using test::exact;
using test::HighPrecision;

/// Three operations: what the two hi words lose, nobody gives back.
float subtractInThree(const DoubleFloat& x, const DoubleFloat& y) { return (x.hi - y.hi) + (x.lo - y.lo); }

struct Worst {
  double three = 0, eighteen = 0;  ///< u
};

/// Over pairs with |x - y| / |x| in [2^-k, 2^-k 2).
Worst worstAt(int k, std::uint64_t seed, int samples) {
  test::DoubleFloatOperands operands(seed + static_cast<std::uint64_t>(k));
  Worst worst;
  for (int i = 0; i < samples; ++i) {
    const DoubleFloat x = operands.pair(0, 0);
    const double distance =
        std::ldexp(1.0 + std::ldexp(static_cast<double>(operands.bits(30)), -30), -k) * (operands.bits(1) ? 1.0 : -1.0);
    const DoubleFloat y = subtract(x, fromDouble(distance * std::fabs(static_cast<double>(x.hi))));
    const HighPrecision reference = exact(x) - exact(y);
    if (reference == 0) continue;
    const auto units = [&](float difference) {
      return std::fabs(static_cast<double>(HighPrecision((HighPrecision(difference) - reference) / reference))) /
             kFloatUnit;
    };
    worst.three = std::max(worst.three, units(subtractInThree(x, y)));
    worst.eighteen = std::max(worst.eighteen, units(subtractAndDemote(x, y)));
  }
  return worst;
}

constexpr std::size_t kPositions = 4096;  // stay in the second-level cache

template <class Subtract>
Work timed(const std::vector<DoubleFloat>& positions, Subtract subtraction) {
  return [&positions, subtraction](std::size_t count) {
    const DoubleFloat camera = positions.front();
    std::array<float, 8> sums{};  // so that no addition waits for the one before
    for (std::size_t i = 0; i < count; i += sums.size())
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += subtraction(positions[(i + k) % kPositions], camera);
    const float sum = std::accumulate(sums.begin(), sums.end(), 0.0f);
    return static_cast<double>(sum);
  };
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"closeness", "|x - y| / |x|"},
                    {"way", "way"},
                    {"errorU", "worst relative error, u (2^-24)"},
                    {"timeNs", "time, ns"}};
  std::vector<DoubleFloat> positions;
  test::DoubleFloatOperands operands(settings.seed);
  for (std::size_t i = 0; i < kPositions; ++i) positions.push_back(operands.pair(0, 0));
  const std::vector<double> times = nanosecondsPerItem(
      {timed(positions, [](const DoubleFloat& x, const DoubleFloat& y) { return subtractInThree(x, y); }),
       timed(positions, [](const DoubleFloat& x, const DoubleFloat& y) { return subtractAndDemote(x, y); })},
      settings.quick ? 100'000 : 1'000'000, settings.quick ? 7 : 25);
  constexpr int kClosest = 44;
  int firstFailing = -1;
  double worstThree = 0, worstEighteen = 0;
  for (int k = 0; k <= kClosest; ++k) {
    const Worst worst = worstAt(k, settings.seed, settings.quick ? 2'000 : 50'000);
    report.rows.push_back({std::ldexp(1.0, -k), std::string("3 operations"), worst.three, times[0]});
    report.rows.push_back({std::ldexp(1.0, -k), std::string("18 operations"), worst.eighteen, times[1]});
    if (firstFailing < 0 && worst.three > 4) firstFailing = k;
    worstThree = std::max(worstThree, worst.three);
    worstEighteen = std::max(worstEighteen, worst.eighteen);
    progress.at(static_cast<double>(k + 1) / (kClosest + 1));
  }
  report.plots = {{"Relative error of a difference over how close its operands are", "closeness", "errorU", "way"}};
  report.findings = {
      fmt::format(
          "Down to operands that differ by 2^-{} of their size the three operations are as good as the eighteen. "
          "Closer, their "
          "error grows with the cancellation, to {:.2g} u at 2^-{}; the eighteen stay below {:.2f} u everywhere.",
          firstFailing - 1, worstThree, kClosest, worstEighteen),
      fmt::format("The eighteen take {:.1f} times as long as the three.", times[1] / times[0])};
  return report;
}

const Registration kRegistered(
    {51, "subtract-map", "Where the three-operation subtraction fails",
     "How close may two positions be before the cheap subtraction of pairs loses their difference?", run});

}  // namespace
}  // namespace terrane::accuracy

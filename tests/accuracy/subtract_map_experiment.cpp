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
    worst.three = std::max(worst.three, units(subtractWordsAndDemote(x, y)));
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
                    {"boundU", "bound, u"},
                    {"timeNs", "time, ns"}};
  std::vector<DoubleFloat> positions;
  test::DoubleFloatOperands operands(settings.seed);
  for (std::size_t i = 0; i < kPositions; ++i) positions.push_back(operands.pair(0, 0));
  const std::vector<double> times = nanosecondsPerItem(
      {timed(positions, [](const DoubleFloat& x, const DoubleFloat& y) { return subtractWordsAndDemote(x, y); }),
       timed(positions, [](const DoubleFloat& x, const DoubleFloat& y) { return subtractAndDemote(x, y); })},
      settings.quick ? 100'000 : 1'000'000, settings.quick ? 7 : 25);
  constexpr int kClosest = 44;
  int firstFailing = -1;
  double worstThree = 0, worstEighteen = 0, worstBefore = 0, worstApart = 0;
  for (int k = 0; k <= kClosest; ++k) {
    const Worst worst = worstAt(k, settings.seed, settings.quick ? 2'000 : 50'000);
    const double closeness = std::ldexp(1.0, -k);
    report.rows.push_back({closeness, std::string("3 operations"), worst.three,
                           subtractWordsBound(closeness / (2 + closeness)), times[0]});
    report.rows.push_back({closeness, std::string("18 operations"), worst.eighteen, kSubtractAndDemoteBound, times[1]});
    if (firstFailing < 0 && worst.three > 2.1) firstFailing = k;
    if (k <= 1) worstApart = std::max(worstApart, worst.three);
    if (firstFailing < 0) worstBefore = std::max(worstBefore, worst.three);
    worstThree = std::max(worstThree, worst.three);
    worstEighteen = std::max(worstEighteen, worst.eighteen);
    progress.at(static_cast<double>(k + 1) / (kClosest + 1));
  }
  report.plots = {{"Relative error of a difference over how close its operands are", "closeness", "errorU", "way"}};
  constexpr double kEarthMeters = 6.371e6;
  report.findings = {
      fmt::format(
          "The three operations err more than the eighteen in two places. Operands that differ by half their size "
          "or more: {:.2f} u against {:.2f} u, for two roundings. And operands closer than 2^-{} of their size "
          "({:.2g} m at the Earth's radius), where what is left is the low words' difference alone: its error "
          "doubles with each bit of closeness, from {:.2g} u to {:.2g} u at 2^-{}. The eighteen stay below {:.2f} "
          "u everywhere.",
          worstApart, worstEighteen, firstFailing - 1, std::ldexp(kEarthMeters, 1 - firstFailing), worstBefore,
          worstThree, kClosest, worstEighteen),
      fmt::format("In metres that is nothing: 2 u² of the distance from the origin, {:.1g} m at the Earth's radius and "
                  "{:.1g} m at 1 AU, whatever the difference. Three operations are enough to place a vertex; eighteen "
                  "are for differences that are used as such, as in a tangent or a normal.",
                  2 * kFloatUnitSquared * kEarthMeters, 2 * kFloatUnitSquared * 1.495978707e11),
      fmt::format("The eighteen take {:.1f} times as long as the three.", times[1] / times[0])};
  return report;
}

const Registration kRegistered(
    {51, "subtract-map", "Where the three-operation subtraction fails",
     "How close may two positions be before the cheap subtraction of pairs loses their difference?", run});

}  // namespace
}  // namespace terrane::accuracy

// Popping: what a change of level does to the picture while the camera flies and tiles come late, and what each way of
// showing it costs a frame.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/span.h"
#include "tests/support/pop_meter.h"

namespace terrane::accuracy {
namespace {

/// None last: what the others' times are compared with.
constexpr std::array kTransitions{Transition::Morph, Transition::Blend, Transition::None};
constexpr std::size_t kNone = kTransitions.size() - 1;

struct Outcome {
  Pops pops;
  double timeRatio = 0;  ///< of a frame, to None's
};
/// One of kTransitions each.
using Outcomes = std::array<Outcome, kTransitions.size()>;

struct Size {
  int widthPixels, heightPixels, frames, moments, rounds;
};

/// Times of the same moments drawn each way, in turn, over those of None.
std::array<double, kTransitions.size()> timeRatios(PopMeter& meter, const std::vector<PopMeter::Moment>& moments,
                                                   int rounds) {
  std::vector<Work> frames;
  for (const Transition transition : kTransitions)
    for (const PopMeter::Moment& moment : moments)
      frames.emplace_back([&meter, &moment, transition](std::size_t) {
        return static_cast<double>(meter.draw(moment, transition).triangles);
      });
  const std::vector<double> times = nanosecondsPerItem(frames, 1, rounds);
  std::array<double, kTransitions.size()> sums{};
  for (std::size_t i = 0; i < times.size(); ++i) sums[i / moments.size()] += times[i];
  const double none = sums[kNone];
  for (double& sum : sums) sum /= none;
  return sums;
}

constexpr std::array kSchemes{Scheme::Cube, Scheme::Ico};

Outcomes measure(Scheme scheme, PopFlight flight, const Size& size, const std::function<void()>& frameDone) {
  TileSource moon(moonScene(scheme));
  Outcomes outcomes;
  for (std::size_t i = 0; i < kTransitions.size(); ++i) {
    PopMeter meter(moon, flight, kTransitions[i], size.widthPixels, size.heightPixels);
    std::vector<PopMeter::Moment> moments;
    int frame = 0;
    outcomes[i].pops = meter.fly(size.frames, [&](const PopMeter::Moment& moment) {
      if (++frame % (size.frames / size.moments) == 0) moments.push_back(moment);
      frameDone();
    });
    if (kTransitions[i] != Transition::Morph) continue;
    const auto ratios = timeRatios(meter, moments, size.rounds);
    for (std::size_t way = 0; way < kTransitions.size(); ++way) outcomes[way].timeRatio = ratios[way];
  }
  return outcomes;
}

std::string findingOf(Transition transition, std::string_view what, const std::vector<Outcomes>& flights) {
  Span rms, perMillion, time;
  const auto at = static_cast<std::size_t>(std::ranges::find(kTransitions, transition) - kTransitions.begin());
  std::uint64_t uncovered = 0;
  int changes = 0;
  for (const Outcomes& flight : flights) {
    rms.include(flight[at].pops.worstRms);
    perMillion.include(flight[at].pops.worstPerMillion);
    time.include(flight[at].timeRatio);
    uncovered += flight[at].pops.uncovered;
    changes += flight[at].pops.changes;
  }
  const std::string cost = transition == Transition::None
                               ? ""
                               : fmt::format("; a frame takes {} times that of tiles drawn at once", time.text());
  return fmt::format(
      "{}: of {} changes the worst differs by {} of 255 (RMS), {} of a million pixels by more than 8 of 255{}. {} "
      "pixels "
      "were left open.",
      what, changes, rms.text(), perMillion.text(), cost, uncovered);
}

Report run(const Settings& settings, Progress& progress) {
  if (auto report = whyNotDrawn()) return *report;
  const Size size = settings.quick ? Size{320, 180, 40, 2, 3} : Size{640, 360, 120, 3, 5};
  Report report;
  report.columns = {{"scheme", "tiles"},
                    {"flight", "flight"},
                    {"transition", "change of level"},
                    {"frames", "frames"},
                    {"changes", "changes of the drawn set"},
                    {"worstRms", "worst RMS difference of the picture, of 255"},
                    {"medianRms", "median RMS difference"},
                    {"worstPerMillion", "worst: pixels per million over 8 of 255"},
                    {"tiles", "tiles a frame"},
                    {"hurried", "changes that could not wait"},
                    {"uncovered", "uncovered pixels"},
                    {"timeRatioToNone", "time of a frame / that of none"}};
  int framesDone = 0;
  const auto frameDone = [&] {
    progress.at(++framesDone / static_cast<double>(kSchemes.size() * kPopFlights.size() * kTransitions.size() *
                                                   static_cast<std::size_t>(size.frames)));
  };
  std::vector<Outcomes> flights;
  const auto addRows = [&](Scheme scheme, PopFlight flight) {
    for (std::size_t i = 0; i < kTransitions.size(); ++i) {
      const auto& [pops, timeRatio] = flights.back()[i];
      report.rows.push_back(
          {std::string(schemeName(scheme)), std::string(popFlightName(flight)),
           std::string(transitionName(kTransitions[i])), std::int64_t{pops.frames}, std::int64_t{pops.changes},
           pops.worstRms, pops.medianRms, pops.worstPerMillion, static_cast<double>(pops.tiles) / pops.frames,
           static_cast<std::int64_t>(pops.hurried + pops.jumps), static_cast<std::int64_t>(pops.uncovered), timeRatio});
    }
  };
  for (const Scheme scheme : kSchemes) {
    for (const PopFlight flight : kPopFlights) {
      flights.push_back(measure(scheme, flight, size, frameDone));
      addRows(scheme, flight);
    }
  }
  report.findings = {findingOf(Transition::Morph, "Morphed", flights),
                     findingOf(Transition::Blend, "Blended by alpha, each level with its skirts", flights),
                     findingOf(Transition::None, "At once, with skirts", flights),
                     fmt::format("Frames are {:.0f} ms apart, and {} square or {} triangular tiles come a frame. {}",
                                 1000 * kPopFrameSeconds, popTilesPerFrame(Scheme::Cube), popTilesPerFrame(Scheme::Ico),
                                 picturesText(size.widthPixels, size.heightPixels))};
  return report;
}

const Registration kRegistered({67, "popping", "Popping",
                                "What is seen of a change of level, and what do ways to hide it cost?", run});

}  // namespace
}  // namespace terrane::accuracy

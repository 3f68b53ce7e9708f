// The horizon and frustum tests of tile selection: what each saves, and that neither is seen.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/gl/moon_stage.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/span.h"

namespace terrane::accuracy {
namespace {

struct Tests {
  const char* name;
  bool horizon, frustum;
};
constexpr std::array<Tests, 4> kTests{{{"horizon and frustum", true, true},
                                       {"frustum only", false, true},
                                       {"horizon only", true, false},
                                       {"none", false, false}}};

SelectionSettings settingsFor(const Tests& tests) {
  return {.frustumCulling = tests.frustum, .horizonCulling = tests.horizon, .maxTiles = 100'000};
}

struct Outcome {
  DrawStats drawn;
  double rms = 0, kibibytes = 0, timeSelectMs = 0, timeFrameMs = 0;
};
using Outcomes = std::array<Outcome, kTests.size()>;

Outcomes measure(MoonStage& stage, int rounds) {
  for (const Tests& tests : kTests) stage.settle(settingsFor(tests));
  Outcomes outcomes;
  Image reference;
  std::vector<Work> ways;
  for (std::size_t i = 0; i < kTests.size(); ++i) {
    const SelectionSettings settings = settingsFor(kTests[i]);
    // Once more: what one selection has taught of heights, all know now.
    const TileSelection selection = stage.settle(settings);
    Outcome& outcome = outcomes[i];
    outcome.drawn = stage.frame(settings);
    const Image picture = stage.picture();
    if (i == 0) reference = picture;
    outcome.rms = rmsDifference(picture, reference);
    outcome.kibibytes = static_cast<double>(stage.wireBytes(selection)) / 1024;
    ways.emplace_back(
        [&stage, settings](std::size_t) { return static_cast<double>(stage.select(settings).draw.size()); });
    ways.emplace_back([&stage, settings](std::size_t) { return static_cast<double>(stage.frame(settings).triangles); });
  }
  const std::vector<double> times = nanosecondsPerItem(ways, 1, rounds);
  for (std::size_t i = 0; i < kTests.size(); ++i) {
    outcomes[i].timeSelectMs = times[2 * i] * 1e-6;
    outcomes[i].timeFrameMs = times[2 * i + 1] * 1e-6;
  }
  return outcomes;
}

/// What some tests alone cost against both.
std::string comparison(const std::vector<Outcomes>& views, std::size_t which) {
  Span tiles, bytes, select, frame;
  for (const Outcomes& view : views) {
    const Outcome &both = view.front(), &some = view[which];
    tiles.include(static_cast<double>(some.drawn.tiles) / static_cast<double>(both.drawn.tiles));
    bytes.include(some.kibibytes / both.kibibytes);
    select.include(some.timeSelectMs / both.timeSelectMs);
    frame.include(some.timeFrameMs / both.timeFrameMs);
  }
  return fmt::format(
      "In place of both tests, {}: {} times the tiles, {} times the bytes, {} times the time to select, {} "
      "times that of a frame.",
      kTests[which].name, tiles.text(), bytes.text(), select.text(), frame.text());
}

std::vector<std::string> findings(const std::vector<Outcomes>& views) {
  Span rms;
  for (const Outcomes& view : views)
    for (const Outcome& outcome : view) rms.include(outcome.rms);
  return {rms.most() == 0
              ? "Nothing that a test leaves out would have been seen: all pictures are the same to the last "
                "bit."
              : fmt::format("A test changes the picture, by up to {:.3g} of 255 (RMS).", rms.most()),
          comparison(views, 1), comparison(views, 2), comparison(views, 3)};
}

Report run(const Settings& settings, Progress& progress) {
  if (auto report = whyNotDrawn()) return *report;
  const int width = settings.quick ? 320 : 960, height = settings.quick ? 180 : 540;
  std::vector<MoonView> views(kMoonViews.begin(), kMoonViews.end());
  if (settings.quick) views = {kMoonViews[0], kMoonViews[1]};

  Report report;
  report.columns = {{"camera", "camera above the ground"},
                    {"heightMeters", "height above the ground, m"},
                    {"tests", "tests"},
                    {"rms", "RMS difference of the picture, of 255"},
                    {"tiles", "tiles drawn"},
                    {"triangles", "triangles drawn"},
                    {"kibibytes", "KiB to fetch, with the tiles above"},
                    {"timeSelectMs", "time, ms to select"},
                    {"timeFrameMs", "time, ms a frame"}};
  std::vector<Outcomes> all;
  for (const MoonView& view : views) {
    auto stage = MoonStage::create(view, width, height);
    if (!stage) return notRun(stage.error());
    all.push_back(measure(**stage, settings.quick ? 3 : 7));
    for (std::size_t i = 0; i < kTests.size(); ++i) {
      const Outcome& o = all.back()[i];
      report.rows.push_back({std::string(view.name), view.aboveGroundMeters, std::string(kTests[i].name), o.rms,
                             static_cast<std::int64_t>(o.drawn.tiles), static_cast<std::int64_t>(o.drawn.triangles),
                             o.kibibytes, o.timeSelectMs, o.timeFrameMs});
    }
    progress.at(static_cast<double>(all.size()) / static_cast<double>(views.size()));
  }
  report.plots = {{"Tiles drawn over the camera's height", "heightMeters", "tiles", "tests"},
                  {"Frame over the camera's height", "heightMeters", "timeFrameMs", "tests"}};
  report.findings = findings(all);
  report.findings.push_back(picturesText(width, height));
  return report;
}

const Registration kRegistered({66, "culling", "Horizon and frustum tests",
                                "What do the tests that leave tiles out save, and do they change the picture?", run});

}  // namespace
}  // namespace terrane::accuracy

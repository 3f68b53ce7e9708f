// Level of detail: what the screen-space error that is allowed does to the picture, and what it costs in tiles, bytes
// and time.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/gl/moon_stage.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/span.h"

namespace terrane::accuracy {
namespace {

constexpr double kReferencePixels = 0.25;
constexpr std::array<double, 7> kErrorPixels{0.5, 1, 2, 4, 8, 16, 32};
constexpr std::size_t kStandard = 2;
static_assert(kErrorPixels[kStandard] == SelectionSettings{}.errorPixels);
/// Above what the reference takes: here the error alone decides.
constexpr int kMaxTiles = 100'000;

SelectionSettings settingsFor(double errorPixels) { return {.errorPixels = errorPixels, .maxTiles = kMaxTiles}; }

struct Outcome {
  double rms = 0, kibibytes = 0, timeMs = 0;
  DrawStats drawn;
  std::size_t levels = 0;  ///< of the tiles drawn
};

/// One of kErrorPixels each.
using Outcomes = std::array<Outcome, kErrorPixels.size()>;

std::size_t levelsOf(const std::vector<FacePath>& paths) {
  std::set<int> levels;
  for (const FacePath& path : paths) levels.insert(path.level());
  return levels.size();
}

Outcomes measure(MoonStage& stage, int rounds) {
  for (const double errorPixels : kErrorPixels) stage.settle(settingsFor(errorPixels));
  stage.settle(settingsFor(kReferencePixels));
  stage.frame(settingsFor(kReferencePixels));
  const Image reference = stage.picture();
  Outcomes outcomes;
  std::vector<Work> frames;
  for (std::size_t i = 0; i < kErrorPixels.size(); ++i) {
    const SelectionSettings settings = settingsFor(kErrorPixels[i]);
    // Once more: finer tiles have taught heights, which may make a selection want others.
    const TileSelection selection = stage.settle(settings);
    Outcome& outcome = outcomes[i];
    outcome.drawn = stage.frame(settings);
    outcome.rms = rmsDifference(stage.picture(), reference);
    outcome.kibibytes = static_cast<double>(stage.wireBytes(selection)) / 1024;
    outcome.levels = levelsOf(selection.draw);
    frames.emplace_back(
        [&stage, settings](std::size_t) { return static_cast<double>(stage.frame(settings).triangles); });
  }
  const std::vector<double> times = nanosecondsPerItem(frames, 1, rounds);
  for (std::size_t i = 0; i < times.size(); ++i) outcomes[i].timeMs = times[i] * 1e-6;
  return outcomes;
}

/// What another error does in place of the default: to the picture, to the bytes and to the frame, over all views.
std::string comparison(const std::vector<Outcomes>& views, std::size_t other) {
  Span rms, bytes, time;
  for (const Outcomes& view : views) {
    rms.include(view[other].rms / view[kStandard].rms);
    bytes.include(view[other].kibibytes / view[kStandard].kibibytes);
    time.include(view[other].timeMs / view[kStandard].timeMs);
  }
  return fmt::format(
      "Allowing {} px in place of {} leaves {} times the difference, for {} times the bytes and {} times "
      "the time of a frame.",
      kErrorPixels[other], kErrorPixels[kStandard], rms.text(), bytes.text(), time.text());
}

std::vector<std::string> findings(const std::vector<Outcomes>& views, const MoonView& lowest) {
  Span rms, finest, tiles;
  for (const Outcomes& view : views) {
    rms.include(view[kStandard].rms);
    finest.include(view.front().rms);
    tiles.include(static_cast<double>(view[kStandard].drawn.tiles));
  }
  const Outcome &coarsest = views.back().back(), &usual = views.back()[kStandard];
  return {fmt::format("At the default of {} px, with {} tiles, a picture differs from the one at {} px by {} of 255 "
                      "(RMS); at {} px still by {}, for this ground has detail of every size.",
                      kErrorPixels[kStandard], tiles.text(), kReferencePixels, rms.text(), kErrorPixels.front(),
                      finest.text()),
          comparison(views, kStandard - 1), comparison(views, kStandard + 1),
          fmt::format("From {} up {} px takes {} tiles of {} levels, the default {} of {}: neighbours differ by one "
                      "level at most, so every level on the way down keeps some tiles however much error is allowed.",
                      lowest.name, kErrorPixels.back(), coarsest.drawn.tiles, coarsest.levels, usual.drawn.tiles,
                      usual.levels)};
}

Report run(const Settings& settings, Progress& progress) {
  if (auto report = whyNotDrawn()) return *report;
  const int width = settings.quick ? 320 : 512, height = settings.quick ? 180 : 288;
  std::vector<MoonView> views(kMoonViews.begin(), kMoonViews.end());
  if (settings.quick) views = {kMoonViews[0], kMoonViews[1]};

  Report report;
  report.columns = {{"camera", "camera above the ground"},
                    {"errorPixels", "error allowed, pixels"},
                    {"rms", "RMS difference of the picture, of 255"},
                    {"tiles", "tiles drawn"},
                    {"triangles", "triangles drawn"},
                    {"kibibytes", "KiB to fetch, with the tiles above"},
                    {"timeFrameMs", "time, ms a frame"}};
  std::vector<Outcomes> all;
  for (const MoonView& view : views) {
    auto stage = MoonStage::create(view, width, height);
    if (!stage) return notRun(stage.error());
    all.push_back(measure(**stage, settings.quick ? 3 : 5));
    for (std::size_t i = 0; i < kErrorPixels.size(); ++i) {
      const Outcome& o = all.back()[i];
      report.rows.push_back({std::string(view.name), kErrorPixels[i], o.rms, static_cast<std::int64_t>(o.drawn.tiles),
                             static_cast<std::int64_t>(o.drawn.triangles), o.kibibytes, o.timeMs});
    }
    progress.at(static_cast<double>(all.size()) / static_cast<double>(views.size()));
  }
  report.plots = {{"Difference of the picture over the error allowed", "errorPixels", "rms", "camera", true, false},
                  {"Difference of the picture over what is fetched", "kibibytes", "rms", "camera", true, false},
                  {"Difference of the picture over the time of a frame", "timeFrameMs", "rms", "camera", true, false}};
  report.findings = findings(all, views.back());
  report.findings.push_back(picturesText(width, height));
  return report;
}

const Registration kRegistered({65, "level-of-detail", "Level of detail",
                                "How much of the picture does each pixel of allowed error cost, and what does it save?",
                                run});

}  // namespace
}  // namespace terrane::accuracy

// Placing a vertex near a camera that is far from the origin, on the CPU: every scheme's error against exact integer
// arithmetic, and its time a vertex.

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/placement/schemes.h"
#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {
namespace {

constexpr std::size_t kVertices = 4096;

using ByName = std::map<std::string_view, double>;

std::vector<std::string> findings(const ByName& atMoon, const ByName& atNeptune, const ByName& ratio) {
  return {
      fmt::format("On the Moon plain float32 misplaces a vertex 2 m away by up to {:.2g} pixels, tiles of 2048 m with "
                  "a float's offset by {:.2g}, the split at 65536 m by {:.2g}; lattice integers and double-float, "
                  "with 3 operations or 18, by {:.1g}, {:.1g} and {:.1g}.",
                  atMoon.at(kFloat32), atMoon.at(kTiles), atMoon.at(kSplit), atMoon.at(kLattice), atMoon.at(kWords),
                  atMoon.at(kDemoted)),
      fmt::format("At 30 AU even float64 errs by {:.2g} pixels, double-float by {:.2g}; lattice integers, which "
                  "subtract before anything is rounded, by {:.1g}, in a third of the bytes. The split ends at 7 AU, "
                  "where multiples of 65536 m are no floats any more: {:.2g} pixels.",
                  atNeptune.at(kCameraRelative), atNeptune.at(kDemoted), atNeptune.at(kLattice), atNeptune.at(kSplit)),
      fmt::format("In time: subtracting in float64 takes {:.1f} times as long as float32, double-float's 3, 18 and 20 "
                  "operations {:.1f}, {:.1f} and {:.1f}, the lattice's integers {:.1f}. What a shader makes of them "
                  "is the next experiment.",
                  ratio.at(kCameraRelative), ratio.at(kWords), ratio.at(kDemoted), ratio.at(kPairs),
                  ratio.at(kLattice))};
}

Report run(const Settings& settings, Progress& progress) {
  const Sample timed = makeSample(kPlaces[kMoonsRadius].meters, settings.seed, kVertices);
  std::vector<Work> ways;
  for (const Scheme& scheme : schemes()) ways.push_back(scheme.onCpu(timed).work);
  const std::vector<double> times =
      nanosecondsPerItem(ways, kVertices * (settings.quick ? 8u : 64u), settings.quick ? 7 : 25);

  Report report;
  report.columns = {{"place", "distance from the origin"},
                    {"originMeters", "distance from the origin, m"},
                    {"scheme", "scheme"},
                    {"errorMeters", "worst error, m"},
                    {"errorPixels", "worst error, pixels at 2 m"},
                    {"bytes", "bytes a vertex"},
                    {"uploadedBytes", "bytes uploaded a vertex and frame"},
                    {"timeNsPerVertex", "time, ns a vertex"},
                    {"timeRatioToFloat32", "time / float32's"}};
  ByName atMoon, atNeptune, ratio;
  for (std::size_t i = 0; i < times.size(); ++i) ratio[schemes()[i].name] = times[i] / times[0];
  for (std::size_t p = 0; p < kPlaces.size(); ++p) {
    for (std::size_t i = 0; i < schemes().size(); ++i) {
      const Scheme& scheme = schemes()[i];
      const double error = worstMetersAt(scheme, kPlaces[p].meters, settings.seed), pixels = pixelsOf(error);
      if (p == kMoonsRadius) atMoon[scheme.name] = pixels;
      atNeptune[scheme.name] = pixels;  // the last place stays
      report.rows.push_back({std::string(kPlaces[p].name), kPlaces[p].meters, std::string(scheme.name), error, pixels,
                             std::int64_t{scheme.bytesPerVertex}, std::int64_t{scheme.uploadedBytesPerVertex}, times[i],
                             times[i] / times[0]});
    }
    progress.at(static_cast<double>(p + 1) / kPlaces.size());
  }
  report.plots = {
      {"Worst error over the distance from the origin", "originMeters", "errorPixels", "scheme"},
      {"Worst error over time, all distances", "timeNsPerVertex", "errorPixels", "scheme", true, true, false}};
  report.findings = findings(atMoon, atNeptune, ratio);
  return report;
}

const Registration kRegistered(
    {10, "placement", "Placing a vertex, on the CPU",
     "A camera stands 2 m from a vertex, far from the origin: how exactly is the vertex placed, and what does "
     "it cost?",
     run});

}  // namespace
}  // namespace terrane::accuracy

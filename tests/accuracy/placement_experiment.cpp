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

double worstMeters(const Sample& sample, const Placed& placed) {
  double worst = 0;
  for (std::size_t i = 0; i < sample.vertices.size(); ++i)
    worst = std::max(worst, errorMeters(placed.at(i), sample.vertices[i], sample.camera));
  return worst;
}

std::vector<std::string> findings(const std::map<std::string_view, double>& atMoon,
                                  const std::map<std::string_view, double>& atNeptune) {
  return {
      fmt::format("On the Moon plain float32 misplaces a vertex 2 m away by {:.2g} pixels, tiles of 2048 m with a "
                  "float's offset by {:.2g}, the split at 65536 m by {:.2g}; lattice integers and the eighteen "
                  "operations of double-float by {:.1g} and {:.1g}.",
                  atMoon.at(kFloat32), atMoon.at(kTiles), atMoon.at(kSplit), atMoon.at(kLattice), atMoon.at(kDemoted)),
      fmt::format("At 30 AU even float64, subtracted by the CPU, errs by {:.2g} pixels, double-float by {:.2g}; "
                  "lattice integers, which subtract before anything is rounded, by {:.1g}, in a third of the bytes.",
                  atNeptune.at(kCameraRelative), atNeptune.at(kDemoted), atNeptune.at(kLattice)),
      "A CPU that has double does best to use it and to subtract there; the times say what the other schemes would "
      "cost it. They are for shaders, which have floats only: see the next experiment."};
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
  std::map<std::string_view, double> atMoon, atNeptune;
  for (std::size_t p = 0; p < kPlaces.size(); ++p) {
    const Sample sample = makeSample(kPlaces[p].meters, settings.seed + p, kVertices);
    for (std::size_t i = 0; i < schemes().size(); ++i) {
      const Scheme& scheme = schemes()[i];
      const double error = worstMeters(sample, scheme.onCpu(sample)), pixels = pixelsOf(error);
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
  report.findings = findings(atMoon, atNeptune);
  return report;
}

const Registration kRegistered(
    {10, "placement", "Placing a vertex, on the CPU",
     "A camera stands 2 m from a vertex, far from the origin: how exactly is the vertex placed, and what does "
     "it cost?",
     run});

}  // namespace
}  // namespace terrane::accuracy

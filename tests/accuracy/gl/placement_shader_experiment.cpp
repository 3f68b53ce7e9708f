// Placing a vertex in a vertex shader: every scheme's error and time, as this machine's OpenGL runs it.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "client/gl/capabilities.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/gl/shader_scheme.h"

namespace terrane::accuracy {
namespace {

using ByName = std::map<std::string_view, double>;

std::vector<std::string> findings(const ByName& times, const ByName& atMoon, const ByName& sameAsCpu) {
  const double nothing = times.at(kPassedThrough);
  const bool same = std::ranges::all_of(sameAsCpu, [](const auto& entry) { return entry.second == 0; });
  return {fmt::format(
              "Against a shader that only passes a finished position on, float32 takes {:.2f} times as long, the "
              "lattice's integers {:.2f}, double-float's 3, 18 and 20 operations {:.2f}, {:.2f} and {:.2f}, float64 "
              "{:.2f}; a CPU that computes and uploads the positions of each frame {:.2f}. (On {}.)",
              times.at(kFloat32) / nothing, times.at(kLattice) / nothing, times.at(kWords) / nothing,
              times.at(kDemoted) / nothing, times.at(kPairs) / nothing, times.at(kFloat64) / nothing,
              times.at(kCameraRelative) / nothing, gl::detectCapabilities().renderer),
          same ? "Every scheme that has a CPU form places every vertex on its bits: the errors are those of the table "
                 "before."
               : "Some schemes do not give their CPU form's bits on this GPU.",
          fmt::format("On the Moon float32 is off by {:.2g} pixels, all schemes of Terrane's by {:.1g} or less.",
                      atMoon.at(kFloat32), std::max(atMoon.at(kLattice), atMoon.at(kLatticePairs)))};
}

/// Components that differ from the CPU's form of the scheme, if it has one.
std::optional<std::size_t> differing(const ShaderScheme& scheme, const Sample& sample,
                                     const std::vector<float>& results) {
  const auto onCpu = std::ranges::find(schemes(), scheme.name, &Scheme::name);
  if (onCpu == schemes().end()) return std::nullopt;
  const Placed placed = onCpu->onCpu(sample);
  std::size_t count = 0;
  for (std::size_t i = 0; i < sample.vertices.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      count += placed.at(i)[axis] == results[3 * i + static_cast<std::size_t>(axis)] ? 0u : 1u;
  return count;
}

struct Outcome {
  double worstMeters = 0;
  std::optional<std::size_t> unlikeCpu;
};

/// Over all cameras of a place.
Outcome outcomeAt(Prepared& prepared, double metersFromOrigin, std::uint64_t seed) {
  Outcome outcome;
  for (int camera = 0; camera < kCameras; ++camera) {
    const Sample sample = makeSampleOf(metersFromOrigin, seed, camera, 64);
    load(prepared, sample);
    prepared.run.run();
    outcome.worstMeters = std::max(outcome.worstMeters, worstMeters(sample, prepared.run));
    if (const auto unlike = differing(*prepared.scheme, sample, prepared.run.results()))
      outcome.unlikeCpu = outcome.unlikeCpu.value_or(0) + *unlike;
  }
  return outcome;
}

Report run(const Settings& settings, Progress& progress) {
  if (auto nothing = whyNotDrawn()) return *nothing;
  const std::size_t timedVertices = settings.quick ? 8192 : 65536;
  const Sample timedSample = makeSample(kPlaces[kMoonsRadius].meters, settings.seed, timedVertices);
  auto timed = prepareAll(shaderSchemes(), timedSample);
  if (!timed) return notRun(timed.error());
  const std::vector<double> times = nanosecondsPerVertex(*timed, timedSample, settings.quick ? 7 : 25);
  progress.at(0.5);

  Report report;
  report.columns = {{"place", "distance from the origin"},
                    {"originMeters", "distance from the origin, m"},
                    {"scheme", "scheme"},
                    {"errorMeters", "worst error, m"},
                    {"errorPixels", "worst error, pixels at 2 m"},
                    {"differing", "components unlike the CPU's form"},
                    {"bytes", "bytes a vertex"},
                    {"timeNsPerVertex", "time, ns a vertex"},
                    {"timeRatioToFloat32", "time / float32's"}};
  ByName timeOf, atMoon, sameAsCpu;
  for (std::size_t i = 0; i < times.size(); ++i) timeOf[shaderSchemes()[i].name] = times[i];
  for (std::size_t p = 0; p < kPlaces.size(); ++p) {
    for (Prepared& prepared : *timed) {
      const std::string_view name = prepared.scheme->name;
      const Outcome outcome = outcomeAt(prepared, kPlaces[p].meters, settings.seed);
      const double pixels = pixelsOf(outcome.worstMeters);
      sameAsCpu[name] += static_cast<double>(outcome.unlikeCpu.value_or(0));
      if (p == kMoonsRadius) atMoon[name] = pixels;
      report.rows.push_back({std::string(kPlaces[p].name), kPlaces[p].meters, std::string(name), outcome.worstMeters,
                             pixels, outcome.unlikeCpu ? std::to_string(*outcome.unlikeCpu) : std::string("-"),
                             std::int64_t{prepared.scheme->bytesPerVertex}, timeOf.at(name),
                             timeOf.at(name) / timeOf.at(kFloat32)});
    }
    progress.at(0.5 + 0.5 * static_cast<double>(p + 1) / kPlaces.size());
  }
  report.plots = {
      {"Worst error over the distance from the origin", "originMeters", "errorPixels", "scheme"},
      {"Worst error over time, all distances", "timeNsPerVertex", "errorPixels", "scheme", true, true, false}};
  report.findings = findings(timeOf, atMoon, sameAsCpu);
  return report;
}

const Registration kRegistered(
    {11, "placement-shader", "Placing a vertex, in a shader",
     "The same in GLSL: are the errors the same, and what does each scheme cost a vertex shader?", run});

}  // namespace
}  // namespace terrane::accuracy

// A camera creeps over the ground by a millimetre a frame: how much of what a picture does between two frames is not
// the camera's doing.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/placement/schemes.h"

namespace terrane::accuracy {
namespace {

constexpr Units kStepUnits = 1049;  // a millimetre, and no multiple of anything

struct Noise {
  double rmsPixels = 0, worstPixels = 0, stillShare = 0;
};

/// What the schemes make of the same vertices, less the truth.
std::vector<glm::dvec3> errorsOf(const Scheme& scheme, const Sample& sample) {
  const Placed placed = scheme.onCpu(sample);
  std::vector<glm::dvec3> errors;
  for (std::size_t i = 0; i < sample.vertices.size(); ++i)
    errors.push_back(glm::dvec3(placed.at(i)) - trueRelative(sample.vertices[i], sample.camera));
  return errors;
}

/// The part of a vertex's motion between two frames that the camera did not cause; two axes of it, as on a picture.
/// Anywhere on the way for the RMS; where the camera crosses from one float to the next for the worst.
Noise noiseOf(const Scheme& scheme, double metersFromOrigin, std::uint64_t seed, int cameras) {
  Noise noise;
  double squares = 0;
  std::size_t count = 0, still = 0;
  for (int camera = 0; camera < cameras; ++camera) {
    const bool crossing = camera % 8 == 7;
    Sample sample = makeSample(metersFromOrigin, seed * 1009 + static_cast<std::uint64_t>(camera), 32);
    if (crossing) {
      moveBetweenFloats(sample);
      for (Units& coordinate : sample.camera.units) coordinate -= kStepUnits / 2;
    }
    const std::vector<glm::dvec3> before = errorsOf(scheme, sample);
    sample.camera.units[0] += kStepUnits;
    sample.camera.units[1] += kStepUnits / 3;
    const std::vector<glm::dvec3> after = errorsOf(scheme, sample);
    for (std::size_t i = 0; i < after.size(); ++i) {
      const glm::dvec3 motion = after[i] - before[i];
      const double pixels = pixelsOf(std::hypot(motion.x, motion.y));
      noise.worstPixels = std::max(noise.worstPixels, pixels);
      if (crossing) continue;
      squares += pixels * pixels;
      still += std::fabs(motion.x) >= 0.99e-3 ? 1u : 0u;
      ++count;
    }
  }
  noise.rmsPixels = std::sqrt(squares / static_cast<double>(count));
  noise.stillShare = static_cast<double>(still) / static_cast<double>(count);
  return noise;
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"place", "distance from the origin"},
                    {"originMeters", "distance from the origin, m"},
                    {"scheme", "scheme"},
                    {"rmsPixels", "noise between frames, pixels RMS at 2 m"},
                    {"worstPixels", "worst jump, pixels"},
                    {"stillPercent", "steps a vertex missed or doubled, %"}};
  std::map<std::string_view, Noise> atMoon, atNeptune;
  for (std::size_t p = kMoonsRadius - 1; p < kPlaces.size(); ++p) {
    for (const Scheme& scheme : schemes()) {
      const Noise noise = noiseOf(scheme, kPlaces[p].meters, settings.seed, settings.quick ? 64 : 512);
      if (p == kMoonsRadius) atMoon[scheme.name] = noise;
      if (p + 1 == kPlaces.size()) atNeptune[scheme.name] = noise;
      report.rows.push_back({std::string(kPlaces[p].name), kPlaces[p].meters, std::string(scheme.name), noise.rmsPixels,
                             noise.worstPixels, 100 * noise.stillShare});
    }
    progress.at(static_cast<double>(p - 1) / (kPlaces.size() - 2));
  }
  report.plots = {{"Noise between frames over the distance from the origin", "originMeters", "rmsPixels", "scheme"},
                  {"Worst jump over the distance from the origin", "originMeters", "worstPixels", "scheme"}};
  const Noise &moonFloat = atMoon.at(kFloat32), &farFloat = atNeptune.at(kFloat32);
  report.findings = {
      fmt::format(
          "Creeping over the Moon by a millimetre a frame, float32 shakes vertices 2 m away by {:.2g} pixels from "
          "frame to frame and makes them jump by {:.2g} where the camera crosses from one float to the next; "
          "tiles of 2048 m by {:.2g} and {:.2g}, the split at 65536 m by {:.2g} and {:.2g}; double-float and the "
          "lattice by {:.1g} and {:.1g}.",
          moonFloat.rmsPixels, moonFloat.worstPixels, atMoon.at(kTiles).rmsPixels, atMoon.at(kTiles).worstPixels,
          atMoon.at(kSplit).rmsPixels, atMoon.at(kSplit).worstPixels, atMoon.at(kDemoted).worstPixels,
          atMoon.at(kLattice).worstPixels),
      fmt::format("At 30 AU float32 misses {:.0f} % of the steps (the RMS is then that of standing still) and jumps by "
                  "{:.2g} pixels at last.",
                  100 * farFloat.stillShare, farFloat.worstPixels)};
  return report;
}

const Registration kRegistered({15, "jitter", "A camera that creeps",
                                "How much does a picture tremble while the camera moves by a millimetre a frame?",
                                run});

}  // namespace
}  // namespace terrane::accuracy

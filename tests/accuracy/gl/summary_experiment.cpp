// The schemes for placing a vertex in one table, as game engines' notes have it, with figures in place of marks:
// precision, performance, versatility.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/gl/capabilities.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/gl/shader_scheme.h"

namespace terrane::accuracy {
namespace {

constexpr double kGoodPixels = 0.1;
constexpr int kFarthestExponent = 43;  // of metres: 58 AU, where the truth's integers end

double worstPixels(const Scheme& scheme, double meters, std::uint64_t seed) {
  return pixelsOf(worstMetersAt(scheme, meters, seed));
}

/// The greatest power of two metres up to which a vertex 2 m away is always good; 0 if never.
double reachMeters(const Scheme& scheme, std::uint64_t seed) {
  double reach = 0;
  for (int exponent = 0; exponent < kFarthestExponent; ++exponent) {
    if (worstPixels(scheme, std::exp2(exponent), seed) > kGoodPixels) break;
    reach = std::exp2(exponent);
  }
  return reach;
}

/// How far apart the vertices of one draw may be: what a vertex stores ends there.
double drawExtentMeters(std::string_view scheme, double reach) {
  return scheme == kLattice || scheme == kLatticePairs ? 65535 * kLatticeMeters : reach;
}

struct Row {
  std::string_view name;
  double moonPixels, neptunePixels, reach;
};

std::vector<Row> measure(const Settings& settings, Progress& progress) {
  std::vector<Row> rows;
  for (const Scheme& scheme : schemes()) {
    rows.push_back({scheme.name, worstPixels(scheme, kPlaces[kMoonsRadius].meters, settings.seed),
                    worstPixels(scheme, kPlaces.back().meters, settings.seed), reachMeters(scheme, settings.seed)});
    progress.at(0.5 * static_cast<double>(rows.size()) / static_cast<double>(schemes().size()));
  }
  return rows;
}

Report run(const Settings& settings, Progress& progress) {
  if (auto nothing = whyNotDrawn()) return *nothing;
  const std::vector<Row> rows = measure(settings, progress);
  const Sample sample = makeSample(kPlaces[kMoonsRadius].meters, settings.seed, settings.quick ? 8192 : 65536);
  auto prepared = prepareAll(shaderSchemes(), sample);
  if (!prepared) return notRun(prepared.error());
  const std::vector<double> times = nanosecondsPerVertex(*prepared, sample, settings.quick ? 5 : 25);
  const auto timeOf = [&](std::string_view name) {
    const auto at = std::ranges::find(shaderSchemes(), name, &ShaderScheme::name);
    return times[static_cast<std::size_t>(at - shaderSchemes().begin())];
  };

  Report report;
  report.columns = {{"scheme", "scheme"},
                    {"moonPixels", "precision: worst pixels off on the Moon"},
                    {"neptunePixels", "pixels off at 30 AU"},
                    {"reachMeters", "reach with 0.1 pixel, m"},
                    {"timeRatioToFloat32", "performance: time / float32's"},
                    {"bytes", "bytes a vertex"},
                    {"uploadedBytes", "uploaded a vertex and frame"},
                    {"drawExtentMeters", "versatility: extent of one draw, m"}};
  double longest = 0;
  for (const Row& row : rows) {
    const auto scheme = std::ranges::find(schemes(), row.name, &Scheme::name);
    report.rows.push_back({std::string(row.name), row.moonPixels, row.neptunePixels, row.reach,
                           timeOf(row.name) / timeOf(kFloat32), std::int64_t{scheme->bytesPerVertex},
                           std::int64_t{scheme->uploadedBytesPerVertex}, drawExtentMeters(row.name, row.reach)});
    longest = std::max(longest, row.reach);
  }
  progress.at(1);
  const auto reachOf = [&](std::string_view name) { return std::ranges::find(rows, name, &Row::name)->reach; };
  report.findings = {
      fmt::format(
          "A tenth of a pixel at 2 m: float32 keeps it to {:.3g} m from the origin, double-float to {:.3g} m with "
          "3 operations and {:.3g} m with 18, the lattice's integers to {:.3g} m and on, for the smallest vertex "
          "of all. What the lattice gives for that: one draw spans one tile, {:.3g} m where its step is a "
          "millimetre; things that move freely take double-float.",
          reachOf(kFloat32), reachOf(kWords), reachOf(kDemoted), reachOf(kLattice), 65535 * kLatticeMeters),
      "Times are a whole vertex shader's on " + gl::detectCapabilities().renderer +
          ", most of which is there without any placing: a fifth more or less is noise. A reach of 0 is none at all."};
  return report;
}

const Registration kRegistered({5, "summary", "Which scheme to choose",
                                "Precision, performance, versatility: which way of placing vertices gives what?", run});

}  // namespace
}  // namespace terrane::accuracy

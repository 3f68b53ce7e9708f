// Depth formats: how far apart two surfaces must be, seen from afar, to be told apart.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "tests/accuracy/experiment.h"

namespace terrane::accuracy {
namespace {

constexpr double kNearMeters = 0.01, kFarMeters = 1e10;

/// A format maps a distance to an ordered integer, as the depth buffer keeps it; float32 all along, as a GPU computes.
using Format = std::int64_t (*)(double meters);

std::int64_t fixed24(float depth) { return std::llround(static_cast<double>(depth) * 16777215.0); }
std::int64_t floatBits(float depth) { return std::bit_cast<std::int32_t>(depth); }

float standardDepth(double meters) {
  const auto a = static_cast<float>(kFarMeters / (kFarMeters - kNearMeters));
  const auto b = static_cast<float>(-kFarMeters * kNearMeters / (kFarMeters - kNearMeters));
  const auto w = static_cast<float>(meters);
  return (a * w + b) / w;
}
float reversedDepth(double meters) { return static_cast<float>(kNearMeters) / static_cast<float>(meters); }
float logarithmicDepth(double meters) {
  const auto scale = static_cast<float>(1 / std::log2(kFarMeters + 1));
  return std::log2(static_cast<float>(meters) + 1.0f) * scale;
}

std::int64_t standard24(double meters) { return fixed24(standardDepth(meters)); }
std::int64_t standardFloat(double meters) { return floatBits(standardDepth(meters)); }
std::int64_t reversed24(double meters) { return -fixed24(reversedDepth(meters)); }
std::int64_t reversedFloat(double meters) { return -floatBits(reversedDepth(meters)); }
std::int64_t logarithmic24(double meters) { return fixed24(logarithmicDepth(meters)); }
std::int64_t logarithmicFloat(double meters) { return floatBits(logarithmicDepth(meters)); }

struct Named {
  const char* name;
  Format depth;
};
constexpr std::array<Named, 6> kFormats{{{"24 bits", standard24},
                                         {"float", standardFloat},
                                         {"24 bits, reversed", reversed24},
                                         {"float, reversed (Terrane)", reversedFloat},
                                         {"24 bits, logarithmic", logarithmic24},
                                         {"float, logarithmic", logarithmicFloat}}};

/// The least separation at which the farther of two surfaces is farther in the buffer wherever both are moved by less
/// than a hundredth of the distance; infinite beyond what the format can tell at all.
double separationMeters(Format depth, double meters, int places) {
  double worst = 0;
  for (int i = 0; i < places; ++i) {
    const double at = meters * (1 + 0.01 * i / places);
    const std::int64_t here = depth(at);
    double low = 0, high = meters * 1e-9;
    while (depth(at + high) <= here) {
      high *= 2;
      if (high > 1e3 * meters) return INFINITY;
    }
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (depth(at + middle) > here ? high : low) = middle;
    }
    worst = std::max(worst, high);
  }
  return worst;
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"format", "format"},
                    {"distanceMeters", "distance, m"},
                    {"separationMeters", "least separation told apart, m"},
                    {"separationShare", "separation / distance"}};
  const int places = settings.quick ? 40 : 400;
  double reversedWorst = 0, standardAt = 0;
  for (std::size_t f = 0; f < kFormats.size(); ++f) {
    for (int decade = -1; decade <= 9; ++decade) {
      const double meters = std::pow(10.0, decade), separation = separationMeters(kFormats[f].depth, meters, places);
      report.rows.push_back({std::string(kFormats[f].name), meters, separation, separation / meters});
      if (kFormats[f].depth == reversedFloat) reversedWorst = std::max(reversedWorst, separation / meters);
      if (kFormats[f].depth == standard24 && decade == 3) standardAt = separation;
    }
    progress.at(static_cast<double>(f + 1) / kFormats.size());
  }
  report.plots = {{"Least separation over distance", "distanceMeters", "separationMeters", "format"}};
  report.findings = {
      fmt::format("With the near plane at {} m, 24 bits of ordinary depth need surfaces {:.3g} m apart at 1 km; "
                  "reversed float needs "
                  "{:.2g} of the distance at any distance.",
                  kNearMeters, standardAt, reversedWorst),
      "Logarithmic depth is as even, but must be written by the pixel shader, which turns early depth tests off."};
  return report;
}

const Registration kRegistered(
    {80, "depth", "Depth formats",
     "How far apart must two surfaces be, at a distance, for a depth buffer to tell them apart?", run});

}  // namespace
}  // namespace terrane::accuracy

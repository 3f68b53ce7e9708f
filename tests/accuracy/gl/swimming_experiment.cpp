// Texture coordinates: does the ground's texture lie still on the ground?

#include <fmt/format.h>

#include <array>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/span.h"
#include "tests/support/swim_meter.h"

namespace terrane::accuracy {
namespace {

using test::TextureCoordinates;

struct Flight {
  double heightMeters;
  int frames;
};
constexpr std::array<Flight, 6> kFlights{{{0.2, 100}, {0.5, 1000}, {2, 100}, {100, 100}, {1e4, 50}, {1e6, 50}}};
constexpr std::array<Flight, 2> kQuickFlights{{{0.5, 20}, {1e4, 20}}};
constexpr int kControlFrames = 50;

Report run(const Settings& settings, Progress& progress) {
  if (auto report = whyNotDrawn()) return *report;
  const std::span<const Flight> flights =
      settings.quick ? std::span<const Flight>(kQuickFlights) : std::span<const Flight>(kFlights);
  Report report;
  report.columns = {{"scheme", "tiles"},
                    {"heightMeters", "camera above the ground, m"},
                    {"coordinates", "texture coordinates"},
                    {"frames", "frames"},
                    {"wavelengthMeters", "wavelength asked, m"},
                    {"worstPixels", "worst, pixels off the ground"},
                    {"medianPixels", "median, pixels"}};
  std::array sources{TileSource(moonScene(Scheme::Cube)), TileSource(moonScene(Scheme::Ico))};
  Span byOctave;
  double floatAtHalfAMeter = 0;
  const std::size_t runs = sources.size() * flights.size();
  for (std::size_t flown = 0; flown < runs; ++flown) {
    const std::size_t i = flown % flights.size();
    TileSource& moon = sources[flown / flights.size()];
    for (const TextureCoordinates coordinates : {TextureCoordinates::ByOctave, TextureCoordinates::Float32}) {
      const bool control = coordinates == TextureCoordinates::Float32;
      const auto swim =
          test::measureSwim(moon, {.heightMeters = flights[i].heightMeters,
                                   .frames = control ? std::min(kControlFrames, flights[i].frames) : flights[i].frames,
                                   .coordinates = coordinates});
      if (!swim) return notRun(swim.error());
      if (!control) byOctave.include(swim->worstPixels);
      if (control && flights[i].heightMeters == 0.5) floatAtHalfAMeter = std::max(floatAtHalfAMeter, swim->worstPixels);
      report.rows.push_back({std::string(schemeName(moon.selection().scheme)), flights[i].heightMeters,
                             std::string(control ? "float32 in the body" : "by octave from the camera (Terrane)"),
                             static_cast<std::int64_t>(swim->frames), swim->wavelengthMeters, swim->worstPixels,
                             swim->medianPixels});
    }
    progress.at(static_cast<double>(flown + 1) / static_cast<double>(runs));
  }
  report.plots = {{"Texture off the ground over the camera's height", "heightMeters", "worstPixels", "coordinates"}};
  report.findings = {
      fmt::format("By octave from the camera, a texel followed over the ground is off by at most {:.2g} of a pixel, at "
                  "every height.",
                  byOctave.most()),
      fmt::format("In float32 it is {:.3g} pixels off half a metre above the ground.", floatAtHalfAMeter)};
  return report;
}

const Registration kRegistered({68, "swimming", "Texture coordinates",
                                "Does the ground's texture lie still on the ground as the camera creeps by?", run});

}  // namespace
}  // namespace terrane::accuracy

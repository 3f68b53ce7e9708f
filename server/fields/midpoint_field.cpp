#include "server/fields/midpoint_field.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/numerics/strict_math.h"
#include "common/tiling/lattice.h"
#include "server/fields/midpoint_samples.h"

namespace terrane {
namespace {

double parameter(const Body& body, std::string_view name) { return body.fieldParameters.find(name)->second; }

/// Grey by height: lowlands dark, highlands bright. Heights beyond half of what there can be are as good as never.
float reflectanceAt(double heightMeters, double largestMeters) noexcept {
  constexpr double kMiddle = 0.14, kSpan = 0.1;
  const double share = largestMeters > 0 ? std::clamp(2.0 * heightMeters / largestMeters, -1.0, 1.0) : 0.0;
  return static_cast<float>(kMiddle + kSpan * (share * (1.5 - 0.5 * share * share)));
}

Scheme schemeOf(const Body& body) noexcept { return body.schemes.empty() ? Scheme::Cube : body.schemes.front(); }

}  // namespace

Result<void> MidpointField::check(const Body& body) {
  const double amplitude = parameter(body, "amplitude"), regularity = parameter(body, "regularity");
  const double most = mostAmplitudeMeters(body.radiusMeters, schemeOf(body), regularity);
  if (amplitude <= most) return {};
  return makeError(
      ErrorKind::TooLarge, "midpoint.amplitude",
      fmt::format("{:.6g} m is too high or steep for a radius of {:.6g} m at regularity {:.6g}; allowed: at most "
                  "{:.6g} m",
                  amplitude, body.radiusMeters, regularity, most));
}

MidpointField::MidpointField(const Body& body)
    : radius_(body.radiusMeters),
      amplitude_(parameter(body, "amplitude")),
      regularity_(parameter(body, "regularity")),
      seed_(body.seed),
      scheme_(schemeOf(body)),
      displacement_(amplitude_, regularity_, seed_) {}

int MidpointField::gridLevelOf(double minWavelengthMeters) const noexcept {
  // Those asked for are two cells of some level, but for a few ulps.
  int level = 0;
  double wavelength = 2.0 * nominalTileWidthMeters(radius_, 0, scheme_);
  while (level < MidpointDisplacement::kFinestGridLevel && 0.5 * wavelength * 1.000001 >= minWavelengthMeters) {
    wavelength *= 0.5;
    ++level;
  }
  return level;
}

void MidpointField::evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const {
  const std::size_t count = batch.count();
  out.resize(count);
  const midpoint::Surface surface{displacement_, gridLevelOf(minWavelengthMeters), radius_};
  if (batch.grid && !batch.grid->isWholeGrid()) return sampleEdge(surface, *batch.grid, out.heightMeters);
  if (batch.grid) {
    sampleGrid(surface, *batch.grid, out);
  } else {
    sampleDirections(surface, scheme_, batch, out);
  }
  const double largest = heightRange().maxMeters;
  for (std::size_t i = 0; i < count; ++i) out.reflectance[i] = reflectanceAt(out.heightMeters[i], largest);
}

double MidpointField::omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept {
  return displacement_.largestSumMeters(gridLevelOf(minWavelengthMeters), gridLevelOf(finestWavelengthMeters));
}

double MidpointField::interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept {
  return omittedAmplitudeMeters(2.0 * spacingMeters, minWavelengthMeters);
}

HeightRange MidpointField::heightRange() const noexcept {
  const double highest = displacement_.largestHeightMeters();
  return {-highest, highest};
}

std::string MidpointField::identity() const {
  return fmt::format("midpoint 1 seed={} amplitude={:a} regularity={:a}", seed_, amplitude_, regularity_);
}

}  // namespace terrane

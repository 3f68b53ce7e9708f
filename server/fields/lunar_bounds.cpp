#include "server/fields/lunar_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace terrane::lunar {
namespace {

/// The outline o = 1 + lobes, orders 2..5, amplitudes shared out as in feature_layers.cpp: what stretching by it does
/// to slopes and curvatures of a function of r o(bearing).
struct OutlineBounds {
  double gradient;         ///< |grad (r o)| <= this
  double squareCurvature;  ///< |Hessian (r o)^2| <= this
  double radiusCurvature;  ///< |Hessian (r o)| <= this / r
};
OutlineBounds outlineBounds(double lobes) noexcept {
  const double most = 1 + lobes, first = 3.25 * lobes, second = 11.85 * lobes;  // o, |o'|, |o''|
  const double q = most * most, q1 = 2 * most * first, q2 = 2 * first * first + 2 * most * second;
  return {std::sqrt(most * most + first * first), std::sqrt(4 * q * q + 2 * q1 * q1 + (q2 + 2 * q) * (q2 + 2 * q)),
          most + second};
}

FeatureBounds craterBounds(const Feature& f) noexcept {
  const OutlineBounds outline = outlineBounds(kCraterLobes);
  const double width = kApronRadii - 1, squareRadius = f.radius * f.radius;
  const auto bowl = [&](double x) { return std::max(f.apex + f.rise * x * x, f.floor); };
  const auto apron = [&](double x) {
    const double a = std::max(0.0, (kApronRadii - x) / width);
    return f.rim * a * a * a;
  };
  // The apron has no weight within `inner`, the bowl none beyond `outer` (both curves are monotone).
  double inner = 0, above = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (inner + above);
    (apron(middle) - bowl(middle) > f.rimBlend ? inner : above) = middle;
  }
  const double outer = std::sqrt(1 + f.rimBlend / f.rise);

  FeatureBounds b;
  b.outsideHigh = f.rim;
  b.outsideLow = -f.rimBlend / 6;
  b.high = std::max(f.rim, f.floor + f.floorBlend / 6 + f.peak);
  b.low = f.floor - f.rimBlend / 6;

  const double bowlSlope = 2 * f.rise * outer * outline.gradient / f.radius;
  const double peakSlope = f.peak * (6 / std::sqrt(kPeakRadiusSquared)) * 0.2863 * outline.gradient / f.radius;
  const auto apronSlope = [&](double x) {
    const double a = (kApronRadii - x) / width;
    return 3 * f.rim * a * a / width * outline.gradient / f.radius;
  };
  const double steepApron = apronSlope(inner);
  b.slope = std::max(bowlSlope, steepApron) + peakSlope;
  // Outside the bowl, where apron < bowl: the crest's rounding gives the bowl at most half the weight.
  b.outsideSlope = std::max(0.5 * bowlSlope, apronSlope(1));
  b.crestSlope = bowlSlope + steepApron;
  b.crestBlend = f.rimBlend;
  const double floorEdge = std::sqrt(std::max(0.0, f.floor + f.floorBlend - f.apex) / f.rise);
  b.floorSlope = 2 * f.rise * floorEdge * outline.gradient / f.radius;
  b.floorBlend = f.floorBlend;

  const auto apronCurvature = [&](double x) {
    const double a = (kApronRadii - x) / width;
    return 6 * f.rim * a / (width * width) * outline.gradient * outline.gradient / squareRadius +
           3 * f.rim * a * a / width * outline.radiusCurvature / (std::max(x, 0.05) * squareRadius);
  };
  const double bowlCurvature = f.rise * outline.squareCurvature / squareRadius;
  const double peakCurvature = f.peak *
                               (3 / kPeakRadiusSquared * outline.squareCurvature +
                                6 / kPeakRadiusSquared * outline.gradient * outline.gradient) /
                               squareRadius;
  b.curvature = std::max(bowlCurvature, apronCurvature(inner)) + peakCurvature;
  b.outsideCurvature = std::max(bowlCurvature, apronCurvature(1));
  return b;
}

FeatureBounds rockBounds(const Feature& f) noexcept {
  // Of the rock's own shape; the dome's slope (1.54) and curvature (2 and 8 in place of 1.54 and 32) are below it.
  const OutlineBounds outline = outlineBounds(kRockLobes);
  FeatureBounds b;
  b.high = f.peak;
  b.slope = 2.425 * f.peak * outline.gradient / f.radius;
  b.curvature =
      f.peak * (1.54 * outline.squareCurvature + 32 * outline.gradient * outline.gradient) / (f.radius * f.radius);
  return b;
}

void widen(FeatureBounds& to, const FeatureBounds& with) noexcept {
  to.low = std::min(to.low, with.low);
  to.high = std::max(to.high, with.high);
  to.outsideLow = std::min(to.outsideLow, with.outsideLow);
  to.outsideHigh = std::max(to.outsideHigh, with.outsideHigh);
  to.slope = std::max(to.slope, with.slope);
  to.curvature = std::max(to.curvature, with.curvature);
  to.outsideSlope = std::max(to.outsideSlope, with.outsideSlope);
  to.outsideCurvature = std::max(to.outsideCurvature, with.outsideCurvature);
  to.crestSlope = std::max(to.crestSlope, with.crestSlope);
  to.crestBlend = std::min(to.crestBlend, with.crestBlend);
  to.floorSlope = std::max(to.floorSlope, with.floorSlope);
  to.floorBlend = std::min(to.floorBlend, with.floorBlend);
}

/// Features that may overlap freely: at any point the sum runs over a set whose members all overlap one of them.
BoundedComponent overlapping(std::span<const Feature> features, std::size_t subject) noexcept {
  BoundedComponent sum{Part::Young, 0, 0, true, 0, 0, 0, 0};
  for (const Feature& f : features) {
    const double* a = f.center;
    const double* b = features[subject].center;
    const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
    const double limit = f.reach + features[subject].reach;
    if (dx * dx + dy * dy + dz * dz > limit * limit) continue;
    const FeatureBounds one = featureBounds(f);
    sum.low += std::min(0.0, one.low);
    sum.high += std::max(0.0, one.high);
    sum.slope += one.slope;
    // Landmarks are few and large: their kinks count as plain curvature, each with its own rounding.
    sum.curvature += one.curvature + one.crestSlope * one.crestSlope / one.crestBlend +
                     one.floorSlope * one.floorSlope / one.floorBlend;
  }
  return sum;
}

double jensenGap(double slope, double spacing, double blend) noexcept {
  return std::min(slope * spacing * 0.35356, slope * slope * spacing * spacing / (4 * blend));
}

constexpr double kAlways = std::numeric_limits<double>::infinity();

/// Metres, of heights in double on a body of a thousand kilometres: positions round to 2^-33 m there.
constexpr double kDoubleRounding = 1e-6;

void addNoiseBounds(std::span<const NoiseGroup> groups, std::vector<BoundedComponent>& out) {
  const auto addNoise = [&](Part part, double wavelength, double amplitude) {
    const double a = std::fabs(amplitude);
    out.push_back({part, wavelength, wavelength, false, -a * kNoiseBound, a * kNoiseBound, a * kNoiseSlope / wavelength,
                   a * kNoiseCurvature / (wavelength * wavelength)});
  };
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t k = 0; k < groups[g].count; ++k) {
      const NoiseOctave& octave = groups[g].octaves[k];
      const double wavelength = 1 / octave.inverseWavelength;
      if (g == 0) {
        addNoise(Part::Relief, wavelength, octave.amplitude);
        addNoise(Part::Lava, wavelength, octave.lavaAmplitude);
      } else {
        // The modulator is at least one octave longer: its own slope and curvature are worth half and a quarter.
        const double m = groups[g].modulation * kNoiseBound;
        addNoise(Part::Regolith, wavelength, octave.amplitude * (1 + m));
        out.back().slope = octave.amplitude / wavelength *
                           (kNoiseSlope * (1 + m) + groups[g].modulation * 0.5 * kNoiseSlope * kNoiseBound);
        out.back().curvature =
            octave.amplitude / (wavelength * wavelength) *
            (kNoiseCurvature * (1 + m) +
             groups[g].modulation * (kNoiseSlope * kNoiseSlope + 0.25 * kNoiseCurvature * kNoiseBound));
      }
    }
  }
}

void addLandmarkBounds(std::span<const Feature> landmarks, std::vector<BoundedComponent>& out) {
  // Landmark craters come by falling size, so those that a level leaves out are a tail: the k-th component is what the
  // k-th adds.
  BoundedComponent before{Part::Young, 0, 0, true, 0, 0, 0, 0};
  for (std::size_t k = landmarks.size(); k-- > 0;) {
    BoundedComponent worst = before;
    for (std::size_t subject = k; subject < landmarks.size(); ++subject) {
      const BoundedComponent sum = overlapping(landmarks.subspan(k), subject - k);
      worst.low = std::min(worst.low, sum.low);
      worst.high = std::max(worst.high, sum.high);
      worst.slope = std::max(worst.slope, sum.slope);
      worst.curvature = std::max(worst.curvature, sum.curvature);
    }
    out.push_back({Part::Young, landmarks[k].radius, landmarks[k].radius, true, worst.low - before.low,
                   worst.high - before.high, worst.slope - before.slope, worst.curvature - before.curvature});
    before = worst;
  }
}

void addBasinBounds(const Program& program, std::vector<BoundedComponent>& out) {
  // Basins: slopes and curvatures from their closed forms, each taken where it is largest, all overlapping.
  BoundedComponent basins{Part::Relief, kAlways, kAlways, false, 0, 0, 0, 0};
  for (std::size_t i = 0; i < program.basinCount; ++i) {
    BoundedComponent sum{Part::Relief, kAlways, kAlways, false, 0, 0, 0, 0};
    for (std::size_t j = 0; j < program.basinCount; ++j) {
      const Basin &a = program.basins[i], &b = program.basins[j];
      const double dx = a.center[0] - b.center[0], dy = a.center[1] - b.center[1], dz = a.center[2] - b.center[2];
      if (std::sqrt(dx * dx + dy * dy + dz * dz) > a.reach + b.reach) continue;
      // u = r^2 / R^2 <= 1.45; |du| = 2 sqrt(u) / R. Bowl (1 - u^2)^3: |f'| sqrt(u) <= 1.66, ring (1 - q^2)^3: |f'|
      // <= 1.9 / 0.45.
      const double inverse = std::sqrt(b.inverseRadiusSquared);
      sum.low -= b.depth;
      sum.high += b.ring;
      sum.slope += inverse * (2 * 1.66 * b.depth + 2 * 1.2042 * (1.9 / 0.45) * b.ring);
      // |f''| <= 24 and 6 / 0.45^2, |f'| <= 2 and 1.9 / 0.45.
      sum.curvature += b.inverseRadiusSquared *
                       ((24 * 4 + 2 * 2) * b.depth + (6 / (0.45 * 0.45) * 4 * 1.45 + 2 * 1.9 / 0.45) * b.ring);
    }
    basins.low = std::min(basins.low, sum.low);
    basins.high = std::max(basins.high, sum.high);
    basins.slope = std::max(basins.slope, sum.slope);
    basins.curvature = std::max(basins.curvature, sum.curvature);
  }
  out.push_back(basins);
}

void addPatchBounds(const Program& program, std::vector<BoundedComponent>& out) {
  // dry is a product of factors in [0, 1]: its slope is at most the sum of theirs, its curvature at most sum + (sum of
  // slopes)^2.
  BoundedComponent patches{Part::Lava, kAlways, kAlways, false, 0, 0, 0, 0};
  const double rise = program.lavaTop - program.lavaFloor;
  double drySlope = 0;
  for (std::size_t i = 0; i < program.patchCount; ++i) {
    double slope = 0, curvature = 0;
    for (std::size_t j = 0; j < program.patchCount; ++j) {
      const LavaPatch &a = program.patches[i], &b = program.patches[j];
      const double dx = a.center[0] - b.center[0], dy = a.center[1] - b.center[1], dz = a.center[2] - b.center[2];
      if (std::sqrt(dx * dx + dy * dy + dz * dz) > a.reach + b.reach) continue;
      // Quintic fade of (u - inner) ramp, u <= 1: |fade'| <= 1.875, |fade''| <= 5.78.
      slope += 1.875 * b.inverseRamp * 2 / b.reach;
      curvature += (5.78 * b.inverseRamp * b.inverseRamp * 4 + 1.875 * b.inverseRamp * 2) / (b.reach * b.reach);
    }
    drySlope = std::max(drySlope, slope);
    patches.curvature = std::max(patches.curvature, rise * (curvature + slope * slope));
  }
  patches.slope = rise * drySlope;
  patches.low = -rise;
  out.push_back(patches);
}

}  // namespace

FeatureBounds featureBounds(const Feature& feature) noexcept {
  return feature.rise > 0 ? craterBounds(feature) : rockBounds(feature);
}

FeatureBounds layerBounds(const FeatureLayer& layer, double bodyRadius) noexcept {
  FeatureBounds worst;
  constexpr int kSteps = 24;
  const double axis[3] = {1, 0, 0};
  for (int i = 0; i <= kSteps; ++i) {
    const double diameter = layer.smallestDiameter() * (1 + static_cast<double>(i) / kSteps);
    if (layer.stage == FeatureStage::Rock) {
      Feature rock{};
      rock.radius = 0.5 * diameter;
      rock.peak = kRockHeight * rock.radius;
      widen(worst, featureBounds(rock));
      continue;
    }
    for (int j = 0; j <= kSteps; ++j) {
      const double wear = layer.wearMin + (layer.wearMax - layer.wearMin) * j / kSteps;
      widen(worst, featureBounds(makeCrater(axis, bodyRadius, diameter, wear, 1)));
    }
  }
  // The parameters vary smoothly between the grid's points; 2 % cover what lies between.
  for (double* value : {&worst.low, &worst.high, &worst.outsideLow, &worst.outsideHigh, &worst.slope, &worst.curvature,
                        &worst.outsideSlope, &worst.outsideCurvature, &worst.crestSlope, &worst.floorSlope}) {
    *value *= 1.02;
  }
  worst.crestBlend /= 1.02;
  worst.floorBlend /= 1.02;
  return worst;
}

double BoundedComponent::missingShare(double minWavelength) const noexcept {
  if (fades) {
    const double shown = lunar::shownShare(wavelength, minWavelength);
    return 1.0 - shown * (1.0 - domeGap * (1.0 - rockSteepness(wavelength, minWavelength)));
  }
  return wavelength < minWavelength ? 1.0 : 0.0;
}

double BoundedComponent::shownShare(double minWavelength) const noexcept {
  if (!fades) return wavelength < minWavelength ? 0.0 : 1.0;
  // What the k-th landmark adds to a bound is no bound of its own: it counts in whole.
  const double share = lunar::shownShare(longest, minWavelength);
  return wavelength < longest || !(share > 0) ? share : 1.0;
}

LunarBounds::LunarBounds(const Program& program, std::span<const NoiseGroup> groups,
                         std::span<const FeatureLayer> layers, std::span<const Feature> landmarks)
    : radius_(program.radius), lavaBlend_(program.lavaBlend), clampBlend_(program.clampBlend) {
  addNoiseBounds(groups, components_);
  for (const FeatureLayer& layer : layers) {
    const FeatureBounds b = layerBounds(layer, radius_);
    const Part part = layer.stage == FeatureStage::OldCrater ? Part::Relief : Part::Young;
    components_.push_back({part, layer.wavelengthMeters(), layer.longestWavelengthMeters(), true,
                           b.low + 3 * b.outsideLow, b.high + 3 * b.outsideHigh, b.slope + 3 * b.outsideSlope,
                           b.curvature + 3 * b.outsideCurvature, b.crestSlope, b.crestBlend, b.floorSlope, b.floorBlend,
                           layer.stage == FeatureStage::Rock ? kDomeGap : 0.0});
  }
  addLandmarkBounds(landmarks, components_);
  addBasinBounds(program, components_);
  addPatchBounds(program, components_);
  double rough = 0;
  for (const BoundedComponent& c : components_) rough += c.part == Part::Regolith ? c.omitted() : 0;
  range_ = {program.clampLow - rough, program.clampHigh + rough};
}

double LunarBounds::omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept {
  if (minWavelengthMeters <= finestWavelengthMeters) return 0;
  std::array<double, 4> sums{};
  for (const BoundedComponent& c : components_) {
    if (c.longest < finestWavelengthMeters) continue;
    sums[static_cast<std::size_t>(c.part)] += c.missingShare(minWavelengthMeters) * c.omitted();
  }
  const double total = std::max(sums[0], sums[1]) + sums[2] + sums[3];
  if (total == 0) return 0;
  const double rounding =
      singleRounding(minWavelengthMeters) + singleRounding(finestWavelengthMeters) + kDoubleRounding;
  return std::min(total * (1 + 1e-9) + rounding, range_.maxMeters - range_.minMeters);
}

double LunarBounds::interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept {
  const double s = spacingMeters;
  std::array<double, 4> errors{}, slopes{};
  for (const BoundedComponent& c : components_) {
    const double shown = c.shownShare(minWavelengthMeters);
    if (!(shown > 0)) continue;
    // Along the sphere the second derivative also has the slope times the path's own curvature, at most 2 / R with the
    // grid's warp.
    const double bend = c.curvature + c.slope * 4 / radius_;
    const auto part = static_cast<std::size_t>(c.part);
    const double kinks = 4 * jensenGap(c.crestSlope, s, c.crestBlend) + jensenGap(c.floorSlope, s, c.floorBlend);
    errors[part] += shown * std::min({0.25 * s * s * bend + kinks, 0.70711 * s * c.slope, c.high - c.low});
    slopes[part] += shown * c.slope;
  }
  const double flood = jensenGap(slopes[0] + slopes[1], s, lavaBlend_);
  const double clamp = jensenGap(std::max(slopes[0], slopes[1]) + slopes[2], s, clampBlend_);
  // Regolith is calmed by up to the dry land's slope times its own size: both are in the patches' slope, far below this
  // allowance.
  const double total = std::max(errors[0], errors[1]) + flood + errors[2] + clamp + 1.05 * errors[3];
  const double rounding = 2 * singleRounding(minWavelengthMeters) + kDoubleRounding;
  return std::min(total * (1 + 1e-9) + rounding, range_.maxMeters - range_.minMeters);
}

}  // namespace terrane::lunar

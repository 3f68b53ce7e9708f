#include "server/fields/far_ground.h"

#include <algorithm>
#include <cmath>

#include "common/numerics/strict_math.h"
#include "server/fields/far_feature.h"
#include "server/fields/lunar_bounds.h"

namespace terrane::lunar {
namespace {

constexpr double kSlack = 1 + 1e-6;  ///< for all roundings of what is compared

/// How far the polynomial goes from its first coefficient over -1 <= a, b <= 1.
template <class Real, int kDegree>
double largestChange(const FarPolynomial<Real, kDegree>& p) noexcept {
  double sum = 0;
  for (int term = 1; term < farTerms(kDegree); ++term) sum += std::abs(static_cast<double>(p.coefficients[term]));
  return sum;
}

struct Range {
  double low, high;
};
Range rangeOf(const FarHeight& p) noexcept {
  const double change = largestChange(p);
  return {p.coefficients[0] - change, p.coefficients[0] + change};
}

double largest(const FarSlope& p) noexcept {
  return std::abs(static_cast<double>(p.coefficients[0])) + largestChange(p);
}

template <class Real, int kDegree>
void add(FarPolynomial<Real, kDegree>& to, Real share, const FarPolynomial<Real, kDegree>& from) noexcept {
  to.isConstant = to.isConstant && from.isConstant;
  for (int term = 0; term < farTerms(kDegree); ++term) to.coefficients[term] += share * from.coefficients[term];
}

/// What is between the heights and slopes with some near parts and those without.
struct NearSpan {
  double low = 0, high = 0;  ///< metres
  double slope = 0;
};

/// The bounds of lunar_bounds.cpp for one crater.
double slopeOf(const Feature& f) noexcept {
  constexpr double kOutline = 1.15;
  return (2 * f.rise * std::sqrt(1 + f.rimBlend / f.rise) + 8.4 * f.rim + 7.1 * f.peak) * kOutline / f.radius;
}

/// Of octaves of relief and lava, and of old craters.
NearSpan oldSpan(const Program& near, const Ball& patch) noexcept {
  NearSpan span;
  for (std::size_t k = 0; k < near.relief.count; ++k) {
    const NoiseOctave& octave = near.relief.octaves[k];
    const double amplitude = std::abs(octave.amplitude) + std::abs(octave.lavaAmplitude);
    span.low -= kNoiseBound * amplitude;
    span.high += kNoiseBound * amplitude;
    span.slope += kNoiseSlope * amplitude * octave.inverseWavelength;
  }
  for (std::size_t k = 0; k < near.runCount; ++k) {
    const FeatureRun& run = near.runs[k];
    for (std::size_t i = 0; run.stage == FeatureStage::OldCrater && i < run.count; ++i) {
      const HeightSpan one = craterSpan(run.features[i], near, patch);
      span.low += one.low;
      span.high += one.high;
      span.slope += slopeOf(run.features[i]);
    }
  }
  return span;
}

/// Of young craters and rocks. The finer level shows some more of less than its radius: landmarks, and of two classes
/// of size craters of two kinds and rocks, at most four of each at a point (feature_layers.h). None is higher or deeper
/// than its radius, and all but one of a layer are there with their ejecta alone.
NearSpan youngSpan(const Program& near, const Ball& patch) noexcept {
  const double finer = 2 * 3 * 4 * near.minWavelength;
  NearSpan span{-finer, finer};
  for (std::size_t k = 0; k < near.runCount; ++k) {
    const FeatureRun& run = near.runs[k];
    for (std::size_t i = 0; run.stage != FeatureStage::OldCrater && i < run.count; ++i) {
      const Feature& f = run.features[i];
      const HeightSpan one = run.stage == FeatureStage::Rock ? HeightSpan{0, f.peak} : craterSpan(f, near, patch);
      span.low += one.low;
      span.high += one.high;
    }
  }
  return span;
}

/// How far one of relief and lava must be above the other to be all that is seen: see roundedMax and landShare.
double blendOver(const Program& near, double nearSlope, const FarExpansion& far) noexcept {
  const double x = largest(far.reliefX) + largest(far.lavaX), y = largest(far.reliefY) + largest(far.lavaY),
               z = largest(far.reliefZ) + largest(far.lavaZ);
  return std::max(near.lavaBlend, 1.5 * near.footprint * (std::sqrt(x * x + y * y + z * z) + nearSlope)) * kSlack;
}

/// Relief becomes the height of what is on top, young that of what else is far.
void joinHeights(bool isLava, const FarHeight& lavaSurface, FarExpansion& far) noexcept {
  if (isLava) far.relief = lavaSurface;
  add(far.young, far.calm, far.rough);
}

void joinSlopes(bool isLava, FarExpansion& far) noexcept {
  const float calm = static_cast<float>(far.calm);
  const auto join = [&](FarSlope& relief, const FarSlope& lava, const FarSlope& young, const FarSlope& rough) {
    if (isLava) relief = lava;
    add(relief, 1.0f, young);
    add(relief, calm, rough);
  };
  join(far.reliefX, far.lavaX, far.youngX, far.roughX);
  join(far.reliefY, far.lavaY, far.youngY, far.roughY);
  join(far.reliefZ, far.lavaZ, far.youngZ, far.roughZ);
}

}  // namespace

void simplifyGround(const Program& near, const Ball& patch, FarExpansion& far) noexcept {
  const double dry = far.dry.coefficients[0];
  if (near.basinCount > 0 || near.patchCount > 0 || !far.dry.isConstant || (dry != 0 && dry != 1)) return;
  const double lavaLevel = near.lavaTop - (near.lavaTop - near.lavaFloor) * dry;
  FarHeight lavaSurface = far.lava, above = far.relief;
  lavaSurface.coefficients[0] += lavaLevel;
  add(above, -1.0, lavaSurface);
  const Range difference = rangeOf(above);
  const NearSpan old = oldSpan(near, patch);
  const double blend = blendOver(near, old.slope, far);
  const bool isLand = difference.low + old.low * kSlack > blend, isLava = difference.high + old.high * kSlack < -blend;
  if (!isLand && !isLava) return;

  FarHeight sum = isLand ? far.relief : lavaSurface;
  add(sum, 1.0, far.young);
  const Range clamped = rangeOf(sum);
  const NearSpan young = youngSpan(near, patch);
  const double lowest = clamped.low + (old.low + young.low) * kSlack,
               highest = clamped.high + (old.high + young.high) * kSlack;
  if (!(lowest > near.clampLow + near.clampBlend * kSlack && highest < near.clampHigh - near.clampBlend * kSlack))
    return;

  far.ground = isLand ? FarGround::Land : FarGround::Lava;
  // As composed sample by sample, to the bit.
  far.calm = static_cast<double>(1.0f - static_cast<float>(near.mareSmoothing) * (1.0f - static_cast<float>(dry)));
  const double perMeter = static_cast<double>(kHeightTint) * near.inverseReliefAmplitude;
  far.tintPerMeter = static_cast<float>(perMeter);
  far.tint = isLand ? kHighlandTint : static_cast<float>(static_cast<double>(kBasaltTint) - perMeter * lavaLevel);
  joinHeights(isLava, lavaSurface, far);
  joinSlopes(isLava, far);
}

}  // namespace terrane::lunar

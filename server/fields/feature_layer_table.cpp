// How many craters and rocks of which size and age a body has.

#include <algorithm>
#include <cmath>

#include "server/fields/feature_layers.h"

namespace terrane::lunar {

std::vector<FeatureLayer> makeLayers(const LayerSettings& settings) {
  std::vector<FeatureLayer> layers;
  const double halfCircle = 1.5707963267948966 * settings.radiusMeters;  // a face is a quarter of a great circle wide
  const auto add = [&](FeatureStage stage, int exponent, double occupancy, double wearMin, double wearMax, double skew,
                       std::uint64_t salt) {
    FeatureLayer layer;
    layer.stage = stage;
    layer.exponent = exponent;
    layer.occupancy = occupancy;
    layer.wearMin = wearMin;
    layer.wearMax = wearMax;
    layer.wearSkew = skew;
    layer.seed = mixHash(settings.seed ^ mixHash(salt * 1000 + static_cast<std::uint64_t>(exponent + 100)));
    const double cells = std::floor(halfCircle / (2 * layer.largestDiameter()));
    if (cells < 2 || layer.wavelengthMeters() < settings.finestDetailMeters || occupancy <= 0) return;
    layer.cellsPerFace = static_cast<std::uint32_t>(std::min(cells, 4294967295.0));
    layers.push_back(layer);
  };
  const double craters = settings.craterDensity, rocks = settings.rockDensity;
  // From 524 km down to 2 km: highland craters, older than the lava; twice over, for they stand rim on rim.
  constexpr double kOld[] = {0.5, 0.8, 0.85, 0.85, 0.7, 0.65, 0.55, 0.5};
  for (int k = 18; k >= 11; --k) {
    add(FeatureStage::OldCrater, k, craters * kOld[18 - k], k >= 15 ? 0.05 : 0.1, k >= 15 ? 0.75 : 0.85, 1, 1);
    if (k <= 17) add(FeatureStage::OldCrater, k, craters * 0.75, 0.3, k >= 15 ? 0.9 : 0.95, 1, 5);
  }
  // Younger than the lava: few large ones, saturated from some hundred metres down.
  for (int k = 14; k >= -4; --k) {
    constexpr double kYoung[] = {0.09, 0.11, 0.14, 0.19, 0.26, 0.4, 0.6, 0.8};  // 16 km .. 128 m
    const int index = 14 - k;
    const double share = index < 8 ? kYoung[index] : 0.92;
    const bool small = k <= 8;
    add(FeatureStage::YoungCrater, k, craters * share, 0.0, small ? 0.95 : 0.8, small ? 2 : 1, 2);
    if (k <= 8) add(FeatureStage::YoungCrater, k, craters * 0.85, 0.5, 0.97, 1, 3);
  }
  // Boulders of metres down to grains.
  constexpr double kRock[] = {0.004, 0.008, 0.015, 0.025, 0.035, 0.05, 0.07, 0.1, 0.16, 0.25, 0.35};
  for (int k = 1; k >= -9; --k) add(FeatureStage::Rock, k, rocks * kRock[1 - k], 0, 0, 1, 4);
  std::stable_sort(layers.begin(), layers.end(),
                   [](const FeatureLayer& a, const FeatureLayer& b) { return a.exponent > b.exponent; });
  return layers;
}

}  // namespace terrane::lunar

// Halos where two levels meet: the crater in the middle is new to the finer of them, its halo is not.

#include <gtest/gtest.h>

#include <cstdio>

#include "server/fields/feature_layers.h"
#include "tests/unit/fields/field_samples.h"

namespace terrane::lunar {
namespace {

using namespace terrane::test;

/// Bright halos of one size class, all over the Moon.
std::vector<Halo> brightHalos(int exponent, std::size_t count) {
  std::mt19937_64 random(1969);
  std::vector<Halo> bright, near;
  const std::vector<FeatureLayer> layers = makeLayers({kMoonRadius, 1.0, 0.0, 0.001, 1969});
  while (bright.size() < count) {
    const glm::dvec3 at = randomDirection(random) * kMoonRadius;
    near.clear();
    for (const FeatureLayer& layer : layers)
      if (layer.exponent == exponent)
        gatherHalos(layer, kMoonRadius, PatchTarget(Ball{{at.x, at.y, at.z}, 20 * layer.largestDiameter()}), near);
    for (const Halo& h : near)
      if (h.brightness > 0.04f && bright.size() < count) bright.push_back(h);
  }
  return bright;
}

/// Mean reflectance so many crater radii from the middle, as a level shows it.
double meanAround(const HeightField& field, const Halo& halo, double radii, double minWavelength) {
  const glm::dvec3 center(halo.center[0], halo.center[1], halo.center[2]);
  const glm::dvec3 axis1(halo.axis1[0], halo.axis1[1], halo.axis1[2]),
      axis2(halo.axis2[0], halo.axis2[1], halo.axis2[2]);
  constexpr int kPoints = 20;
  Directions ring;
  for (int i = 0; i < kPoints; ++i) {
    const double bearing = 2 * 3.14159265358979323846 * i / kPoints;
    ring.add(glm::normalize(center + radii * halo.radius * (std::cos(bearing) * axis1 + std::sin(bearing) * axis2)));
  }
  SampleBatch batch = ring.batch();
  batch.footprintMeters = 0.5 * minWavelength;
  SurfaceSamples samples;
  field.evaluate(batch, minWavelength, samples);
  double sum = 0;
  for (const float reflectance : samples.reflectance) sum += static_cast<double>(reflectance);
  return sum / kPoints;
}

TEST(Halo, IsAsBrightToTheLevelThatLacksItsCraterAsToTheNext) {
  const auto field = makeHeightField(testMoon(), bestSimdPath());
  constexpr double kRing = 2.6;  // beyond the ejecta
  constexpr double kOfMiddle =
      (1 - kRing * kRing / (kHaloRadii * kHaloRadii)) * (1 - kRing * kRing / (kHaloRadii * kHaloRadii));
  for (const int exponent : {4, 7, 11}) {
    double step = 0, brightness = 0, contrast = 0;
    const std::vector<Halo> halos = brightHalos(exponent, 200);
    for (const Halo& halo : halos) {
      const double coarse = 1.1 * halo.radius;  // shows craters of larger radii only
      const double there = meanAround(*field, halo, kRing, coarse);
      step += meanAround(*field, halo, kRing, coarse / 2) - there;
      contrast += there - meanAround(*field, halo, 2 * kHaloRadii, coarse);
      brightness += static_cast<double>(halo.brightness) * kOfMiddle;
    }
    std::printf("2^%d m: halo %.4f, to the next level %+.4f, over the ground far around %.4f\n", exponent,
                brightness / 200, step / 200, contrast / 200);
    EXPECT_LT(std::fabs(step), 0.15 * brightness) << exponent;
    EXPECT_GT(contrast, 0.5 * brightness) << exponent;
  }
}

}  // namespace
}  // namespace terrane::lunar

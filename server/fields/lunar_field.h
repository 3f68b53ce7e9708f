#pragma once
// The Moon as a height field. Body frame, metres; immutable and thread-safe. In order of age.
//
// relief: broad noise, the great basins (lunar_landmarks.h), and the old craters of the highlands, on top of each
// other.
//
// lava: stands in the basins at its own nearly level height, surface = roundedMax(relief, lava), so that coasts, bays,
// islands and half-drowned craters come out by themselves; where lava wins, the ground is dark and smooth.
//
// young: craters of all sizes since then (feature_layers.h), down to decimetres, and rocks and stones; the sum is
// clamped to the stated range by a C2 curve that leaves the middle as it is.
//
// regolith: fractal noise whose slopes grow slowly towards small scales, rougher in some places than in others.
//
// Noise is shown from a wavelength of two cells on; craters and rocks from a radius of two cells on, first in part
// (shownShare, lunar_program.h), so that none is cut where levels meet; halos by their own radius, wide as they are, so
// that what is a bright spot to one level is none to the next.
//
// What is short beside a level's cells is computed in float32 relative to its cell or centre, the rest in double
// (kDoubleWavelengths); inside tiles, what is long beside them is expanded (far_field.h). Every SIMD path and thread
// gives the same bits, and every batch of which no tolerance is asked.

#include <memory>
#include <string>
#include <vector>

#include "server/fields/feature_gathering.h"
#include "server/fields/height_field.h"
#include "server/fields/lunar_bounds.h"
#include "server/fields/lunar_program.h"

namespace terrane {

class LunarField final : public HeightField {
 public:
  LunarField(const Body& body, SimdPath simd);
  void evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const override;
  double omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept override;
  double interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept override;
  double roundingMeters(double minWavelengthMeters) const noexcept override {
    return lunar::singleRounding(minWavelengthMeters);
  }
  HeightRange heightRange() const noexcept override;
  std::string identity() const override;

 private:
  class Evaluation;
  void makeNoise();
  void makeFeatures();
  void makeLandmarks(lunar::FeatureTables& features);

  double radius_;
  std::uint64_t seed_;
  double mareFraction_, craterDensity_, roughness_, rockDensity_, finestDetail_;
  lunar::EvaluateBlock evaluateBlock_;

  std::vector<lunar::NoiseOctave> octaves_;
  std::vector<lunar::NoiseGroup> groups_;  ///< the first is relief
  std::vector<lunar::Basin> basins_;
  std::vector<lunar::LavaPatch> patches_;
  std::vector<lunar::RaySystem> rays_;
  std::shared_ptr<const lunar::FeatureTables> features_;
  lunar::LunarBounds bounds_;
  lunar::Program base_{};  ///< without noise counts and runs
};

}  // namespace terrane

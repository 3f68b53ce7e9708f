#pragma once
// The bare sphere: height 0 and no gradient everywhere, one colour. All bounds are 0. Thread-safe.

#include "server/fields/height_field.h"

namespace terrane {

class SphereField final : public HeightField {
 public:
  void evaluate(const SampleBatch& batch, double minWavelengthMeters, SurfaceSamples& out) const override;
  double omittedAmplitudeMeters(double, double) const noexcept override { return 0; }
  double interpolationErrorMeters(double, double) const noexcept override { return 0; }
  double roundingMeters(double /*minWavelengthMeters*/) const noexcept override { return 0; }
  HeightRange heightRange() const noexcept override { return {0, 0}; }
  std::string identity() const override { return "sphere 1"; }
};

}  // namespace terrane

#pragma once
// Proven bounds of the lunar field, from the same tables that the kernels run. Every feature class and octave is one
// component with a range, a largest slope and a largest curvature (Lipschitz constant of the gradient), all in metres
// on the sphere of radius R.
//
// Noise. With the fade's weights w_c >= 0, sum 1, |n| <= sum of w_c max_g |g . d_c| over the eight corners; its largest
// value over the cell is 1.0364. In the same way the slope along a unit vector e is at most the sum over corners of
// max_g e . grad(w_c g . d_c), and the curvature at most that of max_g e . Hessian . e: the largest values over cell
// and directions are 3.75 and 14.5 (bounds_test recomputes all three), stated here with a margin for what lies between
// the search's points. Craters. A bowl lies in its own cell and an apron reaches at most three cells more
// (feature_layers.h), so of one layer a point sees at most one bowl and four aprons. Outside its bowl a crater's height
// is within [-rimBlend / 6, rim]. Composition. roundedMax moves by no more than the larger of its arguments' moves, the
// clamp by no more than its argument, and a modulated octave by at most (1 + modulation 1.0364) times its own bound. So
// what is left out is bounded by max(relief, lava) + young + regolith, each the sum over its components. Interpolation.
// For a component f between samples s apart, |f - bilinear| is at most the smallest of s^2/4 curvature, s/sqrt(2) slope
// and the range. A roundedMax of half-width b (crest, floor, flood, clamp) adds the gap of Jensen's inequality to the
// error of its arguments: at most min(slope s / (2 sqrt 2), slope^2 s^2 / (4 b)) with the slope of their difference, as
// its second derivative is <= 1/b and its first lies in [0, 1]. Immutable after construction, thread-safe.

#include <span>
#include <vector>

#include "common/tiling/tile_bounds.h"
#include "server/fields/feature_layers.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {

inline constexpr double kNoiseBound = 1.0364;
inline constexpr double kNoiseSlope = 3.85;
inline constexpr double kNoiseCurvature = 15.0;

/// Worst values that one crater of any size and wear of its class can show.
struct FeatureBounds {
  double low = 0, high = 0;                ///< of one, anywhere
  double outsideLow = 0, outsideHigh = 0;  ///< of one, outside its bowl
  double slope = 0, curvature = 0;         ///< curvature without the kinks below
  double outsideSlope = 0, outsideCurvature = 0;
  double crestSlope = 0, crestBlend = 1e300;  ///< slope of bowl against apron, half-width of its rounding
  double floorSlope = 0, floorBlend = 1e300;  ///< slope of bowl against floor where they meet
};
FeatureBounds featureBounds(const Feature& feature) noexcept;
/// Over all features that a layer can hold.
FeatureBounds layerBounds(const FeatureLayer& layer, double bodyRadius) noexcept;

enum class Part : std::uint8_t { Relief, Lava, Young, Regolith };

struct BoundedComponent {
  Part part;
  double wavelength;  ///< the shortest in it; infinite for what every level shows
  double longest;     ///< the longest in it: levels between the two show some of its features
  bool fades;         ///< features: shown in part (shownShare) by levels that just show them
  double low, high, slope, curvature;
  double crestSlope = 0, crestBlend = 1, floorSlope = 0, floorBlend = 1;
  double domeGap = 0;  ///< rocks: how much of their height their shape still lacks at levels that show domes
  double omitted() const noexcept { return -low > high ? -low : high; }
  /// The most that a level leaves out of it, and the most that it shows of it, as shares of the bounds above. Landmarks
  /// come by falling size and are bounded by tails, so their shares sum by parts (Abel).
  double missingShare(double minWavelength) const noexcept;
  double shownShare(double minWavelength) const noexcept;
};

class LunarBounds {
 public:
  LunarBounds() = default;
  LunarBounds(const Program& program, std::span<const NoiseGroup> groups, std::span<const FeatureLayer> layers,
              std::span<const Feature> landmarks);

  double omittedAmplitudeMeters(double minWavelengthMeters, double finestWavelengthMeters) const noexcept;
  double interpolationErrorMeters(double minWavelengthMeters, double spacingMeters) const noexcept;
  HeightRange heightRange() const noexcept { return range_; }

 private:
  std::vector<BoundedComponent> components_;
  HeightRange range_;
  double radius_ = 0, lavaBlend_ = 1, clampBlend_ = 1;
};

}  // namespace terrane::lunar

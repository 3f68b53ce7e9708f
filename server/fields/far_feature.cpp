#include "server/fields/far_feature.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "common/numerics/strict_math.h"

namespace terrane::lunar {

#include "server/fields/lunar_profile.inl"

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Span {
  double low, high;
  bool crosses(double joint) const noexcept { return low <= joint && joint <= high; }
};

/// Wider than all roundings of what is compared.
Span widened(double low, double high) noexcept {
  const double slack = 1e-9 * (std::abs(low) + std::abs(high));
  return {low - slack, high + slack};
}

/// Of the joints of a rounded edge: where it begins and ends, for the height and for the slope, and its middle.
bool crossesEdge(const Span& difference, double inverseBlend, double inverseSoft) noexcept {
  for (const double half : {1.0 / inverseBlend, 1.0 / inverseSoft})
    if (difference.crosses(half) || difference.crosses(-half)) return true;
  return difference.crosses(0);
}

double distance(const double a[3], const double b[3]) noexcept {
  const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return std::sqrt((dx * dx + dy * dy) + dz * dz);
}

Span squareDistance(const double center[3], const Ball& patch) noexcept {
  const double d = distance(center, patch.center), near = d > patch.radius ? d - patch.radius : 0;
  return widened(near * near, (d + patch.radius) * (d + patch.radius));
}

/// The patch's middle in a feature's tangent frame: its distance from the axis, metres, and the bearing's cosine and
/// sine.
struct Bearing {
  double range, cosine, sine;
};
template <class T>
Bearing bearingOf(const T& feature, const Ball& patch) noexcept {
  double along = 0, across = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = patch.center[i] - feature.center[i];
    along += d * feature.axis1[i];
    across += d * feature.axis2[i];
  }
  const double range = std::sqrt(along * along + across * across);
  return {range, along / range, across / range};
}

/// The outline over all bearings that the patch is seen under. The sine of their spread is at most radius / range, the
/// angle no more than a tenth larger at kFarFeatureRadii.
Span outlineOver(const Feature& f, const Bearing& at, const Ball& patch) noexcept {
  double cosine = at.cosine, sine = at.sine, lobes = 0, fastest = 0;
  for (int k = 0; k < kLobes; ++k) {
    const double next = cosine * at.cosine - sine * at.sine;
    sine = cosine * at.sine + sine * at.cosine;
    cosine = next;
    lobes += f.lobeCos[k] * cosine + f.lobeSin[k] * sine;
    fastest += (k + 2) * std::sqrt(f.lobeCos[k] * f.lobeCos[k] + f.lobeSin[k] * f.lobeSin[k]);
  }
  const double change = fastest * 1.1 * patch.radius / at.range;
  return {1 + lobes - change, 1 + lobes + change};
}

double apronAt(const Shape<double>& p, double s) noexcept {
  const double rest = (kApronRadii - std::sqrt(s)) / (kApronRadii - 1.0);
  return rest > 0 ? p.rim * (rest * rest * rest) : 0;
}

/// Without the peak: grows with s.
double innerAt(const Shape<double>& p, double s) noexcept {
  const double above = p.apex + p.rise * s - p.floor, size = above < 0 ? -above : above;
  const double t = 1 - size * p.inverseFloorBlend, blend = t > 0 ? t : 0;
  return (above < 0 ? p.floor : p.floor + above) + p.floorBlend * (1.0 / 6.0) * (blend * blend * blend);
}

enum class Piece : std::uint8_t { None, Bowl, Ejecta, Beyond };

/// Which piece of its profile a crater shows over a range of s, bowl, floor and crest taken together; none if a joint
/// is in it.
Piece pieceOver(const Shape<double>& p, const Span& s) noexcept {
  constexpr double kEnd = kApronRadii * kApronRadii;
  if (s.low > kEnd) return Piece::Beyond;
  if (s.crosses(kEnd) || (p.peak != 0 && s.crosses(kPeakRadiusSquared))) return Piece::None;
  const double rest = 1 - s.low / kPeakRadiusSquared;
  const double peak = rest > 0 ? std::abs(p.peak) * (rest * rest * rest) : 0;
  const Span difference =
      widened(innerAt(p, s.low) - peak - apronAt(p, s.low), innerAt(p, s.high) + peak - apronAt(p, s.high));
  if (crossesEdge(difference, p.inverseRimBlend, p.inverseSoftRim)) return Piece::None;
  if (difference.low * p.inverseRimBlend > 1 && difference.low * p.inverseSoftRim > 1) return Piece::Ejecta;
  const Span above = widened(p.apex + p.rise * s.low - p.floor, p.apex + p.rise * s.high - p.floor);
  return crossesEdge(above, p.inverseFloorBlend, p.inverseSoftFloor) ? Piece::None : Piece::Bowl;
}

double sixthPower(double v) noexcept {
  const double square = v * v;
  return square * square * square;
}

/// How much smaller than at kFarFeatureRadii what a polynomial misses is; infinite if the patch is nearer.
double missedShare(double distance, const Ball& patch) noexcept {
  const double share = kFarFeatureRadii * patch.radius / distance;
  return share <= 1 ? sixthPower(share) : kNever;
}

/// s over a patch that is not too near.
Span stretchedOver(const Feature& crater, const Bearing& at, const Ball& patch) noexcept {
  const double inverseSquared = 1.0 / (crater.radius * crater.radius);
  const Span square = squareDistance(crater.center, patch), outline = outlineOver(crater, at, patch);
  return widened(square.low * inverseSquared * (outline.low * outline.low),
                 square.high * inverseSquared * (outline.high * outline.high));
}

double peakAt(const Feature& crater, double s) noexcept {
  const double rest = 1 - s / kPeakRadiusSquared;
  return rest > 0 ? std::abs(crater.peak) * (rest * rest * rest) : 0;
}

}  // namespace

HeightSpan craterSpan(const Feature& crater, const Program& program, const Ball& patch) noexcept {
  const double blend = crater.rimBlend * (1.0 / 6.0);
  const Bearing at = bearingOf(crater, patch);
  if (missedShare(at.range, patch) == kNever)
    return {crater.floor - blend, std::max(crater.rim, crater.floor + crater.floorBlend + std::abs(crater.peak))};
  const Span s = stretchedOver(crater, at, patch);
  if (s.low > kApronRadii * kApronRadii) return {};
  // A rounded minimum of what grows and what falls with s.
  const Shape<double> shape = shapeOf<double>(crater, program);
  const double low = std::min(innerAt(shape, s.low), apronAt(shape, s.high)) - blend;
  const double high = std::min(innerAt(shape, s.high) + peakAt(crater, s.low), apronAt(shape, s.low));
  return {std::min(low, 0.0), std::max(high, 0.0)};
}

double farCraterError(const Feature& crater, const Program& program, const Ball& patch) noexcept {
  const Bearing at = bearingOf(crater, patch);
  const double missed = missedShare(at.range, patch);
  if (missed == kNever) return kNever;
  const Shape<double> shape = shapeOf<double>(crater, program);
  if (shape.shown < 1) return kNever;
  switch (pieceOver(shape, stretchedOver(crater, at, patch))) {
    case Piece::None:
      return kNever;
    case Piece::Beyond:
      return 0;
    case Piece::Ejecta:
      return kFarEjectaError * crater.rim * missed;
    case Piece::Bowl:
      return kFarBowlError * (crater.rim - crater.floor + crater.peak) * missed;
  }
  return kNever;
}

double farBasinError(const Basin& basin, const Ball& patch) noexcept {
  const Span square = squareDistance(basin.center, patch);
  const double radiusSquared = 1.0 / basin.inverseRadiusSquared;
  for (const double joint : {1.0 - kBasinRingHalfWidth, 1.0, 1.0 + kBasinRingHalfWidth})
    if (square.crosses(joint * radiusSquared)) return kNever;
  if (square.low > (1.0 + kBasinRingHalfWidth) * radiusSquared) return 0;
  return kFarBasinError * (basin.depth + basin.ring) * missedShare(std::sqrt(radiusSquared), patch);
}

double farLavaPatchError(const LavaPatch& lava, double heightMeters, const Ball& patch) noexcept {
  const Span square = squareDistance(lava.center, patch);
  const double reachSquared = 1.0 / lava.inverseReachSquared;
  if (square.crosses(reachSquared) || square.crosses(lava.innerSquared * reachSquared)) return kNever;
  const bool isOnRamp = square.low > lava.innerSquared * reachSquared && square.high < reachSquared;
  if (!isOnRamp) return 0;
  return kFarLavaError * heightMeters * missedShare(std::sqrt(reachSquared), patch);
}

bool isFarHalo(const Halo& halo, const Ball& patch) noexcept {
  if (missedShare(bearingOf(halo, patch).range, patch) == kNever) return false;
  return !squareDistance(halo.center, patch).crosses(kHaloRadii * kHaloRadii * halo.radius * halo.radius);
}

}  // namespace terrane::lunar

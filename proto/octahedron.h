#pragma once
// Directions as points of an octahedron that is unfolded into a square, on a grid of 2^bits - 1 values a side, exactly
// as libdraco has them. Without branches, so that loops over these functions become vector instructions; all numbers
// are whole but in octahedralPoint. Private to proto. Thread-safe.

#include <cmath>
#include <cstdint>

#include "common/numerics/strict_math.h"

namespace terrane {

/// The grid: coordinates are 0 .. 2 center, but for directions that libdraco folds over the square's edge.
struct OctahedralGrid {
  std::int32_t center = 0;
  explicit constexpr OctahedralGrid(int bits) noexcept : center((1 << (bits - 1)) - 1) {}
  constexpr std::int32_t greatest() const noexcept { return 2 * center; }
  /// What the stream holds as the number of values.
  constexpr std::int32_t modulus() const noexcept { return 2 * center + 1; }
};

struct OctahedralPoint {
  std::int32_t s = 0, t = 0;
};

constexpr std::int32_t magnitude(std::int32_t x) noexcept { return x < 0 ? -x : x; }
constexpr std::int32_t choose(bool first, std::int32_t a, std::int32_t b) noexcept { return first ? a : b; }

/// Of a whole vector whose coordinates' magnitudes add up to the center. Points of the square's edge stand for one
/// direction in pairs, its corners all for one: libdraco keeps one of them.
constexpr OctahedralPoint octahedralPoint(const OctahedralGrid& grid, std::int32_t x, std::int32_t y,
                                          std::int32_t z) noexcept {
  const std::int32_t center = grid.center, last = grid.greatest();
  const std::int32_t farY = magnitude(y), farZ = magnitude(z);
  const std::int32_t s = choose(x >= 0, y + center, choose(y < 0, farZ, last - farZ));
  const std::int32_t t = choose(x >= 0, z + center, choose(z < 0, farY, last - farY));
  const bool s0 = s == 0, t0 = t == 0, sLast = s == last, tLast = t == last;
  const bool corner = (s0 & t0) | (s0 & tLast) | (sLast & t0);
  const bool mirrorT = (s0 & (t > center)) | (sLast & (t < center));
  const bool mirrorS = (tLast & (s < center)) | (t0 & (s > center));
  const std::int32_t mirroredS = choose(mirrorT, s, choose(mirrorS, last - s, s));
  const std::int32_t mirroredT = choose(mirrorT, last - t, t);
  return {choose(corner, last, mirroredS), choose(corner, last, mirroredT)};
}

/// Of any direction but zero; one shorter than 1e-6 is taken for +x.
inline OctahedralPoint octahedralPoint(const OctahedralGrid& grid, float x, float y, float z) noexcept {
  const double sum =
      std::abs(static_cast<double>(x)) + std::abs(static_cast<double>(y)) + std::abs(static_cast<double>(z));
  const bool usable = sum > 1e-6;
  const double scale = 1.0 / (usable ? sum : 1.0);
  const double scaledX = usable ? x * scale : 1.0, scaledY = usable ? y * scale : 0.0;
  const auto rounded = [&](double value) {  // floor(value + 1/2)
    const double shifted = value * grid.center + 0.5;
    const auto whole = static_cast<std::int32_t>(shifted);
    return whole - choose(static_cast<double>(whole) > shifted, 1, 0);
  };
  const std::int32_t wholeX = rounded(scaledX);
  std::int32_t wholeY = rounded(scaledY);
  std::int32_t wholeZ = grid.center - magnitude(wholeX) - magnitude(wholeY);
  const std::int32_t excess = choose(wholeZ < 0, wholeZ, 0);
  wholeY += choose(wholeY > 0, excess, -excess);
  wholeZ -= excess;
  return octahedralPoint(grid, wholeX, wholeY, choose(usable & (z < 0), -wholeZ, wholeZ));
}

/// What is left of value when predicted is known, both coordinates 0 or more: predicted is first brought into the inner
/// diamond (by unfolding the square the other way) and into its lower left quarter (by a quarter turn), and value with
/// it, so that what is left looks alike all around.
constexpr OctahedralPoint octahedralCorrection(const OctahedralGrid& grid, OctahedralPoint value,
                                               OctahedralPoint predicted) noexcept {
  const std::int32_t center = grid.center;
  const auto unfolded = [center](OctahedralPoint p) {
    const bool both = (p.s >= 0) & (p.t >= 0);
    const std::int32_t sideS = choose(both | (p.s > 0), center, -center);
    const std::int32_t sideT = choose(both | (p.t > 0), center, -center);
    const bool same = sideS == sideT;
    return OctahedralPoint{sideS + choose(same, -p.t, p.t), sideT + choose(same, -p.s, p.s)};
  };
  const OctahedralPoint v{value.s - center, value.t - center}, p{predicted.s - center, predicted.t - center};
  const bool outside = magnitude(p.s) + magnitude(p.t) > center;
  const OctahedralPoint otherV = unfolded(v), otherP = unfolded(p);
  const std::int32_t vs = choose(outside, otherV.s, v.s), vt = choose(outside, otherV.t, v.t);
  const std::int32_t ps = choose(outside, otherP.s, p.s), pt = choose(outside, otherP.t, p.t);
  const bool quarter = (pt < 0) & (ps >= 0), half = (ps > 0) & (pt >= 0), threeQuarters = (pt > 0) & (ps <= 0);
  const std::int32_t ds = vs - ps, dt = vt - pt;
  const std::int32_t turnedS = choose(quarter, dt, choose(half, -ds, choose(threeQuarters, -dt, ds)));
  const std::int32_t turnedT = choose(quarter, -ds, choose(half, -dt, choose(threeQuarters, ds, dt)));
  return {turnedS + choose(turnedS < 0, grid.modulus(), 0), turnedT + choose(turnedT < 0, grid.modulus(), 0)};
}

/// A correction taken the shorter way around.
constexpr std::int32_t shortest(const OctahedralGrid& grid, std::int32_t correction) noexcept {
  return correction - choose(correction > grid.center, grid.modulus(), 0) +
         choose(correction < -grid.center, grid.modulus(), 0);
}

}  // namespace terrane

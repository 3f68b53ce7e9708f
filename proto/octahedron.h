#pragma once
// Directions as points of an octahedron that is unfolded into a square, on a grid of 2^bits - 1 values a side, exactly
// as libdraco has them; four at once. Private to proto. Thread-safe.

#include <cstdint>

#include "proto/vector4.h"

namespace terrane {

/// The grid: coordinates are 0 .. 2 center.
struct OctahedralGrid {
  std::int32_t center = 0;
  explicit constexpr OctahedralGrid(int bits) noexcept : center((1 << (bits - 1)) - 1) {}
  constexpr std::int32_t greatest() const noexcept { return 2 * center; }
  /// What the stream holds as the number of values.
  constexpr std::int32_t modulus() const noexcept { return 2 * center + 1; }
};

struct OctahedralPoints {
  Int4 s, t;
};

/// Of whole vectors whose coordinates' magnitudes add up to the center. Points of the square's edge stand for one
/// direction in pairs, its corners all for one: libdraco keeps one of them.
inline OctahedralPoints octahedralPoints(const OctahedralGrid& grid, Int4 x, Int4 y, Int4 z) noexcept {
  const Int4 center = all4(grid.center), last = all4(grid.greatest());
  const Int4 farY = magnitude(y), farZ = magnitude(z);
  const Int4 s = choose(x >= 0, y + center, choose(y < 0, farZ, last - farZ));
  const Int4 t = choose(x >= 0, z + center, choose(z < 0, farY, last - farY));
  const Int4 s0 = s == 0, t0 = t == 0, sLast = s == last, tLast = t == last;
  const Int4 corner = (s0 & t0) | (s0 & tLast) | (sLast & t0);
  const Int4 mirrorT = (s0 & (t > center)) | (sLast & (t < center));
  const Int4 mirrorS = ~mirrorT & ((tLast & (s < center)) | (t0 & (s > center)));
  return {choose(corner, last, choose(mirrorS, last - s, s)), choose(corner, last, choose(mirrorT, last - t, t))};
}

/// The same of vectors whose first two coordinates are rounded and whose third is what they leave of the center, or
/// would take from it, with the sign of negativeZ (0 or -1).
inline OctahedralPoints octahedralPointsOfRounded(const OctahedralGrid& grid, Int4 x, Int4 y, Int4 negativeZ) noexcept {
  const Int4 z = all4(grid.center) - magnitude(x) - magnitude(y);
  const Int4 excess = z & (z < 0);
  const Int4 keptY = y + choose(y > 0, excess, -excess);
  return octahedralPoints(grid, x, keptY, ((z - excess) ^ negativeZ) - negativeZ);
}

/// What is left of values when predicted is known: that is first brought into the inner diamond (by unfolding the
/// square the other way) and into its lower left quarter (by a quarter turn), and the value with it, so that what is
/// left looks alike all around.
inline OctahedralPoints octahedralCorrections(const OctahedralGrid& grid, const OctahedralPoints& values,
                                              const OctahedralPoints& predicted) noexcept {
  const Int4 center = all4(grid.center), modulus = all4(grid.modulus());
  const auto unfolded = [&](const OctahedralPoints& p) {
    const Int4 both = (p.s >= 0) & (p.t >= 0);
    const Int4 sideS = choose(both | (p.s > 0), center, -center), sideT = choose(both | (p.t > 0), center, -center);
    const Int4 same = sideS == sideT;
    return OctahedralPoints{sideS + choose(same, -p.t, p.t), sideT + choose(same, -p.s, p.s)};
  };
  const OctahedralPoints v{values.s - center, values.t - center}, p{predicted.s - center, predicted.t - center};
  const Int4 outside = magnitude(p.s) + magnitude(p.t) > center;
  const OctahedralPoints otherV = unfolded(v), otherP = unfolded(p);
  const Int4 ps = choose(outside, otherP.s, p.s), pt = choose(outside, otherP.t, p.t);
  const Int4 ds = choose(outside, otherV.s, v.s) - ps, dt = choose(outside, otherV.t, v.t) - pt;
  const Int4 quarter = (pt < 0) & (ps >= 0), half = (ps > 0) & (pt >= 0), threeQuarters = (pt > 0) & (ps <= 0);
  const Int4 turnedS = choose(quarter, dt, choose(half, -ds, choose(threeQuarters, -dt, ds)));
  const Int4 turnedT = choose(quarter, -ds, choose(half, -dt, choose(threeQuarters, ds, dt)));
  return {turnedS + (modulus & (turnedS < 0)), turnedT + (modulus & (turnedT < 0))};
}

/// How far corrections reach, taken the shorter way around.
inline Int4 correctionLengths(const OctahedralGrid& grid, const OctahedralPoints& corrections) noexcept {
  const Int4 center = all4(grid.center), modulus = all4(grid.modulus());
  const auto shortest = [&](Int4 c) { return magnitude(c - (modulus & (c > center))); };
  return shortest(corrections.s) + shortest(corrections.t);
}

}  // namespace terrane

#pragma once
// Local expansions of the far field (as in Greengard and Rokhlin 1987, "A fast algorithm for particle simulations"):
// what varies slowly over a patch of ground, each of the kernels' sums a polynomial in two coordinates. Plain data;
// body frame, metres. far_field.h says what is far, far_fit.h makes the polynomials, lunar_far.inl evaluates them.

#include <cstddef>

#include "server/fields/lunar_program.h"

namespace terrane::lunar {

/// Degrees of what heights are made of, and of slopes and brightness. All terms a^i b^j with i + j <= degree: row by
/// row, j = 0 first, i upwards.
inline constexpr int kFarHeightDegree = 5, kFarSlopeDegree = 3;
constexpr int farTerms(int degree) noexcept { return (degree + 1) * (degree + 2) / 2; }

template <class Real, int kDegree>
struct FarPolynomial {
  bool isConstant;  ///< then the first coefficient is all
  Real coefficients[farTerms(kDegree)];
};
using FarHeight = FarPolynomial<double, kFarHeightDegree>;
using FarSlope = FarPolynomial<float, kFarSlopeDegree>;

/// What is on top over all of a patch and by more than the blend of the two, so that the other need not be known: then
/// relief is the height of what is on top, young is all that is far beside it, rough is near alone, and the slopes of
/// relief are those of all that is far. See far_ground.h.
enum class FarGround : std::uint8_t { Mixed, Land, Lava };

struct FarExpansion {
  double origin[3];
  double alongA[3], alongB[3];  ///< a = alongA . (position - origin), b likewise; both within -1..1 on the patch
  FarHeight relief, lava, dry, young, rough, last, sum;
  FarSlope reliefX, reliefY, reliefZ, lavaX, lavaY, lavaZ, dryX, dryY, dryZ, youngX, youngY, youngZ;
  FarSlope roughX, roughY, roughZ, lastX, lastY, lastZ, sumX, sumY, sumZ, bright, mottle;

  FarGround ground;
  /// Of ground that is not mixed: what regolith is scaled by, and the reflectance of level ground at relief 0 and what
  /// each metre of relief adds, before it is mottled.
  double calm;
  float tint, tintPerMeter;
};

/// Calls visit(polynomial, array) for each polynomial that an expansion's ground asks for and the array of a block that
/// it is of; either may be const.
template <class Expansion, class Samples, class Visit>
TERRANE_INLINE void forEachFarHeight(Expansion& far, Samples& b, const Visit& visit) {
  visit(far.relief, b.relief);
  visit(far.young, b.young);
  visit(far.last, b.last);
  visit(far.sum, b.sum);
  if (far.ground != FarGround::Mixed) return;
  visit(far.lava, b.lava);
  visit(far.dry, b.dry);
  visit(far.rough, b.rough);
}
template <class Expansion, class Samples, class Visit>
TERRANE_INLINE void forEachFarSlope(Expansion& far, Samples& b, const Visit& visit) {
  visit(far.reliefX, b.reliefX);
  visit(far.reliefY, b.reliefY);
  visit(far.reliefZ, b.reliefZ);
  visit(far.lastX, b.lastX);
  visit(far.lastY, b.lastY);
  visit(far.lastZ, b.lastZ);
  visit(far.sumX, b.sumX);
  visit(far.sumY, b.sumY);
  visit(far.sumZ, b.sumZ);
  visit(far.bright, b.bright);
  visit(far.mottle, b.mottle);
  if (far.ground != FarGround::Mixed) return;
  visit(far.lavaX, b.lavaX);
  visit(far.lavaY, b.lavaY);
  visit(far.lavaZ, b.lavaZ);
  visit(far.dryX, b.dryX);
  visit(far.dryY, b.dryY);
  visit(far.dryZ, b.dryZ);
  visit(far.youngX, b.youngX);
  visit(far.youngY, b.youngY);
  visit(far.youngZ, b.youngZ);
  visit(far.roughX, b.roughX);
  visit(far.roughY, b.roughY);
  visit(far.roughZ, b.roughZ);
}

}  // namespace terrane::lunar

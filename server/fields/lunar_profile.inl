// The profile of a crater: part of every build of the lunar kernels, and of far_feature.cpp.

namespace {

template <class Real>
TERRANE_INLINE Real squareRoot(Real v);
template <>
TERRANE_INLINE float squareRoot(float v) {
  return __builtin_sqrtf(v);
}
template <>
TERRANE_INLINE double squareRoot(double v) {
  return __builtin_sqrt(v);
}

template <class Real>
struct Profile {
  Real value, slope;  ///< metres; its derivative by s = (distance / radius)^2
};

template <class Real>
struct Shape {
  Real apex, rise, floor, floorBlend, inverseFloorBlend, rim, rimBlend, inverseRimBlend, peak;
  /// For slopes: the inverse half-widths of the edges, rounded at least to the footprint; and what it and the level
  /// leave of a slope.
  Real inverseSoftFloor, inverseSoftRim, keptSlope;
  Real shown;      ///< share of the height
  Real steepness;  ///< of a rock
};

template <class Real>
Shape<Real> shapeOf(const Feature& f, const Program& program) {
  const double reach = program.footprint / f.radius;
  const double floorRise = f.floor - f.apex;  // the bowl meets the floor where rise s = floorRise
  const double floorSlope = 2.0 * __builtin_sqrt((floorRise > 0 ? floorRise : 0.0) * f.rise);
  const double rimSlope = 2.0 * f.rise + f.rim * (3.0 / (kApronRadii - 1.0));
  const double shown = shownShare(f.radius, program.minWavelength);
  const double softFloor = floorSlope * reach, softRim = rimSlope * reach;
  return {Real(f.apex),
          Real(f.rise),
          Real(f.floor),
          Real(f.floorBlend),
          Real(1.0 / f.floorBlend),
          Real(f.rim),
          Real(f.rimBlend),
          Real(1.0 / f.rimBlend),
          Real(f.peak),
          Real(1.0 / (softFloor > f.floorBlend ? softFloor : f.floorBlend)),
          Real(1.0 / (softRim > f.rimBlend ? softRim : f.rimBlend)),
          Real(shown * keptSlope(program.footprint, 0.5 / f.radius)),
          Real(shown),
          Real(rockSteepness(f.radius, program.minWavelength))};
}

/// Bowl, flattened below by a floor, cut above by the apron of ejecta: roundedMin(roundedMax(bowl, floor), apron) +
/// peak. Beyond kApronRadii the apron is 0 and the bowl far above it: exactly 0.
template <class Real>
TERRANE_INLINE Profile<Real> craterProfile(const Shape<Real>& p, Real s) {
  const Real zero(0), one(1), half(0.5), sixth = Real(1.0 / 6.0);
  const Real bowl = p.apex + p.rise * s;
  const Real above = bowl - p.floor;
  const Real aboveSize = above < zero ? -above : above;
  Real t = one - aboveSize * p.inverseFloorBlend;
  t = t > zero ? t : zero;
  Real inner = (above < zero ? p.floor : bowl) + p.floorBlend * sixth * (t * t * t);
  Real tSoft = one - aboveSize * p.inverseSoftFloor;
  tSoft = tSoft > zero ? tSoft : zero;
  const Real bowlWeight = above < zero ? half * (tSoft * tSoft) : one - half * (tSoft * tSoft);
  Real innerSlope = bowlWeight * p.rise;

  const Real peakRest = one - s * Real(1.0 / kPeakRadiusSquared);
  const Real q = peakRest > zero ? peakRest : zero;
  inner += p.peak * (q * q * q);
  innerSlope -= p.peak * Real(3.0 / kPeakRadiusSquared) * (q * q);

  const Real distance = squareRoot<Real>(s + Real(1e-12));
  const Real rest = (Real(kApronRadii) - distance) * Real(1.0 / (kApronRadii - 1.0));
  const Real a = rest > zero ? rest : zero;
  const Real apron = p.rim * (a * a * a);
  const Real apronSlope = p.rim * (a * a) * Real(-1.5 / (kApronRadii - 1.0)) / distance;

  const Real difference = inner - apron;
  const Real size = difference < zero ? -difference : difference;
  Real r = one - size * p.inverseRimBlend;
  r = r > zero ? r : zero;
  Real rSoft = one - size * p.inverseSoftRim;
  rSoft = rSoft > zero ? rSoft : zero;
  const Real innerWeight = difference < zero ? one - half * (rSoft * rSoft) : half * (rSoft * rSoft);
  return {((difference < zero ? inner : apron) - p.rimBlend * sixth * (r * r * r)) * p.shown,
          (innerWeight * innerSlope + (one - innerWeight) * apronSlope) * p.keptSlope};
}

/// The distance, in the outline's radii, from which on a crater is its apron alone, to the last bit: there
///   bowl - apron >= (rim + rise (s - 1)) - rim
/// exceeds the crest's rounding for height and slope, by more than float32 rounds.
template <class Real>
TERRANE_INLINE double ejectaFrom(const Shape<Real>& p) {
  const Real narrower = p.inverseRimBlend < p.inverseSoftRim ? p.inverseRimBlend : p.inverseSoftRim;
  return __builtin_sqrt(1.0 + 1.001 / (static_cast<double>(narrower) * static_cast<double>(p.rise)));
}

/// What craterProfile is from ejectaFrom on.
template <class Real>
TERRANE_INLINE Profile<Real> ejectaProfile(const Shape<Real>& p, Real s) {
  const Real distance = squareRoot<Real>(s + Real(1e-12));
  const Real rest = (Real(kApronRadii) - distance) * Real(1.0 / (kApronRadii - 1.0));
  const Real a = rest > Real(0) ? rest : Real(0);
  const Real slope = p.rim * (a * a) * Real(-1.5 / (kApronRadii - 1.0)) / distance;
  return {p.rim * (a * a * a) * p.shown, slope * p.keptSlope};
}

}  // namespace

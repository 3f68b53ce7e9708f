#include "common/tiling/tile_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"

// Notation: a cube tile's footprint is the rectangle a in [a0, a1], b in [b0, b1] of the plane tangent to the face, so
// its directions are those of n + a u + b v, and form a convex cone. That of an ico tile is the spherical triangle of
// its corners. The shell sector S is that cone between the radii rLow and rHigh. All volumes contain S and are convex,
// so they contain every chord between its points too.
//
// Both the footprint and the radii are first grown by one lattice step. Rounding a vertex to the lattice moves it by at
// most sqrt(3)/2 steps; the remaining 0.13 step (>= 4e-6 of the tile's width, and down to level 30 at least 25 ulp of
// the body's radius) is what pays for the rounding of the arithmetic here.

namespace terrane {
namespace {

double dot(const glm::dvec3& p, const glm::dvec3& q) noexcept { return p.x * q.x + p.y * q.y + p.z * q.z; }
double length(const glm::dvec3& p) noexcept { return std::sqrt(dot(p, p)); }
glm::dvec3 cross(const glm::dvec3& p, const glm::dvec3& q) noexcept {
  return glm::dvec3(p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x);
}
glm::dvec3 normalized(const glm::dvec3& p) noexcept {
  const double norm = length(p);
  return glm::dvec3(p.x / norm, p.y / norm, p.z / norm);
}

struct Footprint {
  Scheme scheme;
  FaceAxes axes;  ///< cube, as are a0..b1
  double a0, a1, b0, b1;
  glm::dvec3 center;                  ///< unit
  glm::dvec3 across;                  ///< where the box' first axis is to point
  std::array<glm::dvec3, 4> corners;  ///< unit; (u, v) = 00 10 01 11; of a triangle the last is the third once more
};

/// A vertex moved by `slack` metres at a radius of at least `innerRadius` moves by less than this in the tangent plane:
/// |da| <= |e| sqrt(1 + a^2) / (r cos(angle to n) - |e|), with |a| <= 1 and cos >= 1/sqrt(3), and sqrt(6) < 2.5.
double tangentPlaneMargin(double slack, double innerRadius) noexcept {
  return 2.5 * slack / (innerRadius - 2.0 * slack);
}

/// The three corners are moved away from the centre, in the plane that touches the sphere there, in which a vertex
/// moves by less than `margin` (the same bound: a face's corners are 37.4 degrees from its centre), until each edge has
/// moved by that much.
Footprint triangleFootprint(const FacePath& path, double margin) noexcept {
  const auto corners = icoCornerDirections(kIcoMap, path);
  Footprint f{};
  f.scheme = Scheme::Ico;
  f.center = normalized(corners[0] + corners[1] + corners[2]);
  f.across = corners[1] - corners[0];
  std::array<glm::dvec3, kTriangleCorners> flat{};
  for (std::size_t i = 0; i < flat.size(); ++i) flat[i] = corners[i] * (1.0 / dot(f.center, corners[i])) - f.center;
  double nearestEdge = 1.0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const glm::dvec3 &from = flat[i], &to = flat[(i + 1) % flat.size()];
    nearestEdge = std::min(nearestEdge, length(cross(from, to)) / length(to - from));
  }
  const double grown = 1.0 + margin / nearestEdge;
  for (std::size_t i = 0; i < f.corners.size(); ++i)
    f.corners[i] = normalized(f.center + flat[std::min<std::size_t>(i, 2)] * grown);
  return f;
}

Footprint footprintOf(const FacePath& path, double margin) noexcept {
  if (path.scheme() == Scheme::Ico) return triangleFootprint(path, margin);
  const double scale = std::ldexp(2.0, -path.level());
  const double s0 = static_cast<double>(path.column()) * scale - 1.0;
  const double t0 = static_cast<double>(path.row()) * scale - 1.0;
  Footprint f{};
  f.scheme = Scheme::Cube;
  f.axes = cubeFaceAxes(path.face());
  f.across = f.axes.u;
  f.a0 = tanQuarterPi(s0) - margin;
  f.a1 = tanQuarterPi(s0 + scale) + margin;
  f.b0 = tanQuarterPi(t0) - margin;
  f.b1 = tanQuarterPi(t0 + scale) + margin;
  f.center = cubeDirection(path.face(), s0 + 0.5 * scale, t0 + 0.5 * scale);
  for (int i = 0; i < 4; ++i) {
    const double a = (i & 1) ? f.a1 : f.a0;
    const double b = (i & 2) ? f.b1 : f.b0;
    f.corners[static_cast<std::size_t>(i)] = normalized(f.axes.normal + f.axes.u * a + f.axes.v * b);
  }
  return f;
}

/// The largest dot(axis, d) over the unit directions d of the footprint, for an axis that is not itself one of them.
/// The maximum is then on an edge; along b, (A + b B) / sqrt(1 + a^2 + b^2) peaks at b = B (1 + a^2) / A.
/// Along a great circle it peaks where the axis, projected into the circle's plane, points.
double largestDotOfTriangle(const Footprint& f, const glm::dvec3& axis) noexcept {
  double largest = -1.0;
  for (std::size_t i = 0; i < kTriangleCorners; ++i) {
    const glm::dvec3 &from = f.corners[i], &to = f.corners[(i + 1) % kTriangleCorners];
    largest = std::max(largest, dot(axis, from));
    const glm::dvec3 normal = normalized(cross(from, to));
    const glm::dvec3 peak = axis - normal * dot(normal, axis);
    if (dot(cross(from, peak), normal) > 0 && dot(cross(peak, to), normal) > 0)
      largest = std::max(largest, length(peak));
  }
  return largest;
}

double largestDot(const Footprint& f, const glm::dvec3& axis) noexcept {
  if (f.scheme == Scheme::Ico) return largestDotOfTriangle(f, axis);
  const double n = dot(axis, f.axes.normal);
  const double u = dot(axis, f.axes.u);
  const double v = dot(axis, f.axes.v);
  const auto at = [&](double a, double b) { return (n + (a * u + b * v)) / std::sqrt(1.0 + (a * a + b * b)); };
  double largest = std::max(std::max(at(f.a0, f.b0), at(f.a1, f.b0)), std::max(at(f.a0, f.b1), at(f.a1, f.b1)));
  for (const double a : {f.a0, f.a1}) {
    const double peak = v * (1.0 + a * a) / (n + a * u);  // not finite or outside when there is no peak
    if (peak > f.b0 && peak < f.b1) largest = std::max(largest, at(a, peak));
  }
  for (const double b : {f.b0, f.b1}) {
    const double peak = u * (1.0 + b * b) / (n + b * v);
    if (peak > f.a0 && peak < f.a1) largest = std::max(largest, at(peak, b));
  }
  return largest;
}

/// The largest dot(axis, p) over the shell sector.
double sectorExtent(const Footprint& f, const glm::dvec3& axis, double rLow, double rHigh) noexcept {
  const double largest = largestDot(f, axis);
  return largest > 0 ? rHigh * largest : rLow * largest;
}

/// {d : dot(center, d) >= c} is a convex cap, so the smallest value over the footprint is at a corner.
double smallestCosine(const Footprint& f) noexcept {
  double smallest = 1.0;
  for (const glm::dvec3& corner : f.corners) smallest = std::min(smallest, dot(f.center, corner));
  return smallest;
}

/// Inner corners on the sphere rLow: their hull lies within that sphere, so every ray of the cone meets it at or below
/// rLow. Outer corners on the plane that touches the sphere rHigh in the centre direction: a ray meets it at rHigh /
/// cos >= rHigh.
std::array<glm::dvec3, 8> hullOf(const Footprint& f, double rLow, double rHigh) noexcept {
  std::array<glm::dvec3, 8> hull{};
  for (std::size_t i = 0; i < 4; ++i) {
    hull[i] = f.corners[i] * rLow;
    hull[i + 4] = f.corners[i] * (rHigh / dot(f.center, f.corners[i]));
  }
  return hull;
}

OrientedBox boxOf(const Footprint& f, double rLow, double rHigh) noexcept {
  const glm::dvec3 up = f.center;
  const glm::dvec3 tangentU = normalized(f.across - up * dot(f.across, up));
  const std::array<glm::dvec3, 3> directions{tangentU, cross(up, tangentU), up};
  OrientedBox box;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3& axis = directions[i];
    // `up` is itself a direction of the footprint: its largest dot is 1 and its smallest is at a corner.
    const bool vertical = i == 2;
    const double high = vertical ? rHigh : sectorExtent(f, axis, rLow, rHigh);
    const double low = vertical ? rLow * smallestCosine(f) : -sectorExtent(f, axis * -1.0, rLow, rHigh);
    box.center = box.center + axis * (0.5 * (low + high));
    box.halfAxes[i] = axis * (0.5 * (high - low));
  }
  return box;
}

/// For one radius the distance from a point on the centre axis grows with the angle from it, and along a ray it is
/// convex: the farthest points of the sector are corners at rLow or rHigh. The best centre makes these two equal,
/// unless the outer corners alone decide (a thin shell), when it lies in their chord plane.
Sphere sphereOf(const Footprint& f, double rLow, double rHigh) noexcept {
  const double cosine = smallestCosine(f);
  Sphere sphere;
  sphere.center = f.center * std::min(0.5 * (rLow + rHigh) / cosine, rHigh * cosine);
  for (const glm::dvec3& corner : f.corners) {
    sphere.radiusMeters = std::max(sphere.radiusMeters, length(corner * rLow - sphere.center));
    sphere.radiusMeters = std::max(sphere.radiusMeters, length(corner * rHigh - sphere.center));
  }
  return sphere;
}

/// In units of the occluder: from a point p, |p| = 1/cos(beta), the occluder shows a cap of half-angle beta about p,
/// and a camera sees p exactly when their caps meet. The point with direction `center` and half-angle alpha + beta has
/// a cap that contains p's, alpha being the angle between the two: where it is hidden, p is hidden. Both angles are
/// largest at the highest corner (smallestCosine), and a chord stays within the same cone and radius. Its length is
/// 1/cos(alpha + beta).
glm::dvec3 horizonPointOf(const Footprint& f, double rHigh, double occluderRadius) noexcept {
  constexpr double kLargest = 1e6;  // occluder radii: beyond, the point hides nothing anyway
  double chordSquared = 0;
  for (const glm::dvec3& corner : f.corners) {
    const glm::dvec3 chord = corner - f.center;
    chordSquared = std::max(chordSquared, dot(chord, chord));
  }
  // From the chord, since 1 - cos^2 of a small angle is lost to rounding.
  const double cosAlpha = 1.0 - 0.5 * chordSquared;
  const double sinAlpha = std::sqrt(chordSquared * (1.0 - 0.25 * chordSquared));
  const double height = std::max(rHigh - occluderRadius, 0.0);
  const double cosBeta = occluderRadius / (occluderRadius + height);
  const double sinBeta = std::sqrt(height * (2.0 * occluderRadius + height)) / (occluderRadius + height);
  const double cosine = cosAlpha * cosBeta - sinAlpha * sinBeta;
  if (!(occluderRadius > 0) || !(cosAlpha > 0) || !(cosine * kLargest > 1.0)) {
    return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  }
  return f.center * (occluderRadius / cosine);
}

/// For heights that reach near the body's centre, where a cone bounds nothing.
TileBounds wholeBodyBounds(double rHigh) noexcept {
  TileBounds bounds;
  for (std::size_t i = 0; i < 8; ++i) {
    bounds.hull[i] = glm::dvec3((i & 1) ? rHigh : -rHigh, (i & 2) ? rHigh : -rHigh, (i & 4) ? rHigh : -rHigh);
  }
  bounds.box.halfAxes = {glm::dvec3(rHigh, 0, 0), glm::dvec3(0, rHigh, 0), glm::dvec3(0, 0, rHigh)};
  bounds.sphere.radiusMeters = rHigh;
  bounds.horizonPoint = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
  return bounds;
}

/// Of the part of a surface over `footprintPath` whose vertices lie on a lattice of this step.
TileBounds boundsOver(const FacePath& footprintPath, double step, double radiusMeters, const HeightRange& heights,
                      double occluderRadiusMeters) noexcept {
  const double rLow = radiusMeters + heights.minMeters - step;
  const double rHigh = radiusMeters + heights.maxMeters + step;
  if (!(rLow > 64.0 * step)) return wholeBodyBounds(rHigh);

  const Footprint footprint = footprintOf(
      footprintPath, tangentPlaneMargin((1.0 + skirtCornerFlareSteps(footprintPath.scheme())) * step, rLow));
  TileBounds bounds;
  bounds.hull = hullOf(footprint, rLow, rHigh);
  bounds.box = boxOf(footprint, rLow, rHigh);
  bounds.sphere = sphereOf(footprint, rLow, rHigh);
  bounds.horizonPoint = horizonPointOf(footprint, rHigh, occluderRadiusMeters);
  return bounds;
}

}  // namespace

TileBounds tileBounds(const FacePath& path, double radiusMeters, const HeightRange& heights,
                      double occluderRadiusMeters) noexcept {
  const double step = stepMeters(stepExponent(radiusMeters, path.level(), path.scheme()));
  return boundsOver(path, step, radiusMeters, heights, occluderRadiusMeters);
}

TileBounds tileQuarterBounds(const FacePath& path, int digit, double radiusMeters, const HeightRange& heights,
                             double occluderRadiusMeters) noexcept {
  const double step = stepMeters(stepExponent(radiusMeters, path.level(), path.scheme()));
  return boundsOver(path.child(digit), step, radiusMeters, heights, occluderRadiusMeters);
}

double lowestSurfaceRadiusMeters(double radiusMeters, double lowestHeightMeters, int cellsPerEdge,
                                 Scheme scheme) noexcept {
  // A cell's longer diagonal, per unit of its width, is sqrt((1 + X^2) (1 + Y^2) (2 + (X + Y)^2)) / (1 + X^2 + Y^2) at
  // the face point (X, Y): sqrt(2) in the middle, sqrt(8/3) at a cube corner, where cells are rhombi of 120
  // degrees. 1.2825... is half of that times pi/2. A triangle's nearest point is on its longest edge, or (acute) its
  // circumcentre: no farther off than that. cos x >= 1 - x^2 / 2.
  // An icosahedral cell's edge is at most 1.2 times the face's edge of atan 2 by the number of cells (ico_shapes_test),
  // and its circumcentre, as it is acute, within 1 / sqrt(3) of that.
  const double reach = (scheme == Scheme::Cube ? 1.2825498301618641 : 0.7670552) / static_cast<double>(cellsPerEdge);
  const double step = stepMeters(stepExponent(radiusMeters, 0, scheme));
  return (radiusMeters + lowestHeightMeters) * (1.0 - 0.5 * reach * reach) - step;
}

}  // namespace terrane

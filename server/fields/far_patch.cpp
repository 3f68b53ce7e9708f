#include "server/fields/far_patch.h"

#include <algorithm>
#include <cmath>

#include "common/numerics/strict_math.h"

namespace terrane::lunar {
namespace {

/// The samples between a tile's vertices along its edges, as its skirts ask for, bulge out of what its vertices span.
constexpr double kSlack = 1.01;

double dot(const double a[3], const double b[3]) noexcept { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

void normalize(double v[3]) noexcept {
  const double length = std::sqrt(dot(v, v));
  for (int i = 0; i < 3; ++i) v[i] /= length;
}

struct Span {
  double low, high;
  void add(double v) noexcept {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  double middle() const noexcept { return 0.5 * (low + high); }
  double half() const noexcept { return 0.5 * (high - low) * kSlack; }
};

}  // namespace

void FarPatch::pointAt(double a, double b, double out[3]) const noexcept {
  const double alongA = a * halfA, alongB = b * halfB;
  const double fromA = offsetA + alongA, fromB = offsetB + alongB;
  const double square = fromA * fromA + fromB * fromB;
  const double below = square / (radiusMeters + std::sqrt(radiusMeters * radiusMeters - square));
  for (int i = 0; i < 3; ++i) out[i] = origin[i] + ((axisA[i] * alongA + axisB[i] * alongB) - up[i] * below);
}

FarPatch patchAround(const PointSet& points, std::size_t rowLength, double radiusMeters) noexcept {
  FarPatch patch;
  patch.radiusMeters = radiusMeters;
  std::copy(points.ball.center, points.ball.center + 3, patch.up);
  normalize(patch.up);
  const auto pointOf = [&](std::size_t index, double out[3]) {
    out[0] = points.x[index] * points.scale;
    out[1] = points.y[index] * points.scale;
    out[2] = points.z[index] * points.scale;
  };
  double first[3], last[3];
  pointOf(0, first);
  pointOf(rowLength - 1, last);
  for (int i = 0; i < 3; ++i) patch.axisA[i] = last[i] - first[i];
  const double upwards = dot(patch.axisA, patch.up);
  for (int i = 0; i < 3; ++i) patch.axisA[i] -= upwards * patch.up[i];
  normalize(patch.axisA);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    patch.axisB[i] = patch.up[j] * patch.axisA[k] - patch.up[k] * patch.axisA[j];
  }
  const double touch[3] = {patch.up[0] * radiusMeters, patch.up[1] * radiusMeters, patch.up[2] * radiusMeters};
  Span a{0, 0}, b{0, 0};
  for (std::size_t index = 0; index < points.count; ++index) {
    double p[3];
    pointOf(index, p);
    for (int i = 0; i < 3; ++i) p[i] -= touch[i];
    a.add(dot(p, patch.axisA));
    b.add(dot(p, patch.axisB));
  }
  patch.halfA = a.half();
  patch.halfB = b.half();
  patch.offsetA = a.middle();
  patch.offsetB = b.middle();
  for (int i = 0; i < 3; ++i)
    patch.origin[i] = touch[i] + (patch.axisA[i] * patch.offsetA + patch.axisB[i] * patch.offsetB);
  const double half = std::sqrt(patch.halfA * patch.halfA + patch.halfB * patch.halfB);
  const double furthest = half + std::abs(patch.offsetA) + std::abs(patch.offsetB);
  patch.sag = furthest * furthest / radiusMeters;
  std::copy(patch.origin, patch.origin + 3, patch.ball.center);
  patch.ball.radius = half + patch.sag;
  return patch;
}

}  // namespace terrane::lunar

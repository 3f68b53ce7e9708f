#include "server/fields/feature_target.h"

#include <algorithm>
#include <cmath>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"

namespace terrane::lunar {
namespace {

double dot(const glm::dvec3& a, const double b[3]) noexcept { return a.x * b[0] + a.y * b[1] + a.z * b[2]; }

/// Cells between two tangents of face angles.
CellRange cellsBetween(double low, double high, std::uint32_t cells) noexcept {
  if (low > 1 || high < -1) return {};
  const double scale = 0.5 * static_cast<double>(cells);
  // A little slack absorbs the rounding of atan.
  const double first = std::floor((atanQuarterPi(std::clamp(low, -1.0, 1.0)) + 1) * scale - 1e-3);
  const double last = std::floor((atanQuarterPi(std::clamp(high, -1.0, 1.0)) + 1) * scale + 1e-3);
  const double top = static_cast<double>(cells - 1);
  return {static_cast<std::uint32_t>(std::clamp(first, 0.0, top)),
          static_cast<std::uint32_t>(std::clamp(last, 0.0, top))};
}

/// Cells along one face axis that a ball may touch: the ball's box, projected from the body's centre. along, outward:
/// the ball's centre.
CellRange cellsOfBall(double along, double outward, double reach, std::uint32_t cells) noexcept {
  const double nearest = outward - reach, farthest = outward + reach;
  if (std::fabs(along) - reach > farthest) return {};  // beside or behind the face's pyramid |along| <= outward
  double low = -1, high = 1;
  if (nearest > 0) {
    low = (along - reach) / (along - reach < 0 ? nearest : farthest);
    high = (along + reach) / (along + reach < 0 ? farthest : nearest);
  }
  return cellsBetween(low, high, cells);
}

/// The tangents of face angles along one axis of all that is near some points.
struct TangentRange {
  double low = 1, high = -1;

  /// Of what is within reach of a point: with X = along / outward, another point q has
  ///   Xq - X = ((q - p) . u - X (q - p) . n) / (q . n),
  /// so |Xq - X| <= reach sqrt(1 + X^2) / (outward - reach).
  void add(double along, double outward, double reach) noexcept {
    const double tangent = along / outward;
    const double most = reach * std::sqrt(1 + tangent * tangent) / (outward - reach);
    low = std::min(low, tangent - most);
    high = std::max(high, tangent + most);
  }
};

CellRange common(const CellRange& a, const CellRange& b) noexcept {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

}  // namespace

bool FaceView::isBeyond(const AngleSpan& u, const AngleSpan& v, double reach) const noexcept {
  const auto isOff = [&](double angle, const AngleSpan& span, double circleRadius) {
    const double off = std::max(span.low - angle, angle - span.high);
    if (!(off > 0 && off < 2)) return false;
    const double radians = off * 0.7853981633974483;
    return circleRadius * radians * (1 - radians * radians * (1.0 / 6.0)) > radius + reach;  // sin x >= x - x^3 / 6
  };
  return isOff(angleU, u, circleRadiusU) || isOff(angleV, v, circleRadiusV);
}

FaceView BallTarget::viewOf(int face) const noexcept {
  const FaceAxes& axes = cubeFaceAxes(face);
  const double outward = dot(axes.normal, ball_.center), u = dot(axes.u, ball_.center), v = dot(axes.v, ball_.center);
  // Further round, the angles are not computed, and the circles stay 0: nothing is beyond.
  if (!(outward > 0 && std::max(std::fabs(u), std::fabs(v)) <= 2 * outward)) return {};
  return {ball_.radius, atanQuarterPi(u / outward), atanQuarterPi(v / outward), std::sqrt(outward * outward + u * u),
          std::sqrt(outward * outward + v * v)};
}

CellBlock BallTarget::cells(int face, double reach, std::uint32_t cellsPerFace) const noexcept {
  const FaceAxes& axes = cubeFaceAxes(face);
  const double within = ball_.radius + reach, outward = dot(axes.normal, ball_.center);
  if (outward + within < 0) return {};
  return {cellsOfBall(dot(axes.u, ball_.center), outward, within, cellsPerFace),
          cellsOfBall(dot(axes.v, ball_.center), outward, within, cellsPerFace)};
}

bool BallTarget::touchedFrom(const double at[3], double scale, double reach) const noexcept {
  const double dx = at[0] * scale - ball_.center[0], dy = at[1] * scale - ball_.center[1],
               dz = at[2] * scale - ball_.center[2];
  const double limit = ball_.radius + reach;
  return dx * dx + dy * dy + dz * dz <= limit * limit;
}

RowTarget::RowTarget(const PointSet& points) noexcept : points_(points), ball_(points.ball) {
  double end[3];
  pointAt(0, start_);
  pointAt(points.count - 1, end);
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    along_[a] = end[a] - start_[a];
    square += along_[a] * along_[a];
  }
  if (square > 0) inverseSquareLength_ = 1 / square;
  double farthest = 0, widest = 0, kept[3] = {};
  for (std::size_t i = 0; i < points.count; ++i) {
    double point[3];
    pointAt(i, point);
    if (i % kStride == 0) std::copy(point, point + 3, kept);
    double gap = 0;
    for (int a = 0; a < 3; ++a) gap += (point[a] - kept[a]) * (point[a] - kept[a]);
    widest = std::max(widest, gap);
    farthest = std::max(farthest, squareDistanceFromLine(point));
  }
  bulge_ = std::sqrt(farthest) * (1 + 1e-9);
  gap_ = std::sqrt(widest) * (1 + 1e-9);
}

void RowTarget::pointAt(std::size_t index, double out[3]) const noexcept {
  out[0] = points_.x[index] * points_.scale;
  out[1] = points_.y[index] * points_.scale;
  out[2] = points_.z[index] * points_.scale;
}

double RowTarget::squareDistanceFromLine(const double point[3]) const noexcept {
  const double d[3] = {point[0] - start_[0], point[1] - start_[1], point[2] - start_[2]};
  const double share = (d[0] * along_[0] + d[1] * along_[1] + d[2] * along_[2]) * inverseSquareLength_;
  const double t = std::clamp(share, 0.0, 1.0);
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    const double off = d[a] - t * along_[a];
    square += off * off;
  }
  return square;
}

CellBlock RowTarget::cells(int face, double reach, std::uint32_t cellsPerFace) const noexcept {
  const CellBlock around = ball_.cells(face, reach, cellsPerFace);
  if (around.empty()) return around;
  const FaceAxes& axes = cubeFaceAxes(face);
  TangentRange u, v;
  const double within = reach + gap_;
  for (std::size_t i = 0; i < points_.count; i += kStride) {
    double point[3];
    pointAt(i, point);
    const double outward = dot(axes.normal, point);
    if (!(outward > 2 * within)) return around;  // at the rim of the face's hemisphere
    u.add(dot(axes.u, point), outward, within);
    v.add(dot(axes.v, point), outward, within);
  }
  return {common(around.columns, cellsBetween(u.low, u.high, cellsPerFace)),
          common(around.rows, cellsBetween(v.low, v.high, cellsPerFace))};
}

bool RowTarget::touchedFrom(const double at[3], double scale, double reach) const noexcept {
  const double point[3] = {at[0] * scale, at[1] * scale, at[2] * scale};
  const double limit = bulge_ + reach;
  return squareDistanceFromLine(point) <= limit * limit && ball_.touchedFrom(at, scale, reach);
}

}  // namespace terrane::lunar

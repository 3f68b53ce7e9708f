#include "server/fields/feature_target.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"

namespace terrane::lunar {
namespace {

double dot(const glm::dvec3& a, const double b[3]) noexcept { return a.x * b[0] + a.y * b[1] + a.z * b[2]; }

/// Cells between two face angles.
CellRange cellsBetween(double low, double high, std::uint32_t cells) noexcept {
  if (low > 1 || high < -1) return {};
  const double scale = 0.5 * static_cast<double>(cells);
  // A little slack absorbs the rounding of atan.
  const double first = std::floor((std::max(low, -1.0) + 1) * scale - 1e-3);
  const double last = std::floor((std::min(high, 1.0) + 1) * scale + 1e-3);
  const double top = static_cast<double>(cells - 1);
  return {static_cast<std::uint32_t>(std::clamp(first, 0.0, top)),
          static_cast<std::uint32_t>(std::clamp(last, 0.0, top))};
}

double angleOf(double tangent) noexcept { return atanQuarterPi(std::clamp(tangent, -1.0, 1.0)); }

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
  if (low > 1 || high < -1) return {};
  return cellsBetween(angleOf(low), angleOf(high), cells);
}

constexpr double kRadians = 0.7853981633974483;  ///< in a face angle
/// Further round from the face's middle, angles are not computed.
constexpr double kMostTangent = 2;

/// The least distance from the axis across, in radii, of what lies between tangents along and across:
/// sqrt((1 + X^2) / (1 + X^2 + Y^2)).
double leastCircle(const AngleSpan& along, const AngleSpan& across) noexcept {
  const double nearest = std::max({along.low, -along.high, 0.0}), farthest = std::max(-across.low, across.high);
  const double x = 1 + nearest * nearest;
  return std::sqrt(x / (x + farthest * farthest));
}

/// Points side by side: compilers do not make vectors of the comparisons of doubles.
constexpr std::size_t kLanes = 2;
typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));

/// The least of measures of points.
class Least {
 public:
  void add(const Lanes& v) noexcept { least_ = v < least_ ? v : least_; }
  double value() const noexcept { return std::min(least_[0], least_[1]); }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  Lanes least_ = {kNone, kNone};
};

/// Calls visit(outward, u, v) for all points in the face's axes, some of them twice.
template <class Visit>
void forEachOnFace(int face, const PointSet& points, const Visit& visit) noexcept {
  const FaceAxes& axes = cubeFaceAxes(face);
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    const std::size_t a = i, b = std::min(i + 1, points.count - 1);
    const Lanes x = {points.x[a], points.x[b]}, y = {points.y[a], points.y[b]}, z = {points.z[a], points.z[b]};
    const auto along = [&](const glm::dvec3& axis) { return axis.x * x + axis.y * y + axis.z * z; };
    visit(along(axes.normal), along(axes.u), along(axes.v));
  }
}

}  // namespace

void FaceView::AxisView::close(double slack) noexcept {
  const double more = slack * (tangents.high - tangents.low);
  tangents = {tangents.low - more, tangents.high + more};
  angles = {atanQuarterPi(tangents.low), atanQuarterPi(tangents.high)};
}

FaceView::FaceView(int face, const Ball& ball) noexcept
    : face_(face), outward_(dot(cubeFaceAxes(face).normal, ball.center)), ballRadius_(ball.radius) {
  u_.middle = dot(cubeFaceAxes(face).u, ball.center);
  v_.middle = dot(cubeFaceAxes(face).v, ball.center);
  if (!(outward_ > 0 && std::max(std::fabs(u_.middle), std::fabs(v_.middle)) <= kMostTangent * outward_)) return;
  aroundAngles_ = ball.radius;
  for (AxisView* const axis : {&u_, &v_}) {
    axis->tangents.low = axis->tangents.high = axis->middle / outward_;
    axis->close(0);
    axis->circleRadius = std::sqrt(outward_ * outward_ + axis->middle * axis->middle);
  }
}

FaceView::FaceView(int face, const PointSet& points, double slack) noexcept : FaceView(face, points.ball) {
  if (!(u_.circleRadius > 0)) return;  // most faces: the ball's middle is too far round
  Least outwards, room, lowU, lowV, highU, highV;
  forEachOnFace(face, points, [&](const Lanes& outward, const Lanes& u, const Lanes& v) {
    const Lanes tangentU = u / outward, tangentV = v / outward, most = kMostTangent * outward;
    outwards.add(outward);
    room.add(most - u);
    room.add(most + u);
    room.add(most - v);
    room.add(most + v);
    lowU.add(tangentU);
    highU.add(-tangentU);
    lowV.add(tangentV);
    highV.add(-tangentV);
  });
  if (!(outwards.value() > 0 && room.value() >= 0)) return;
  const auto take = [&](const Least& low, const Least& high, AxisView& axis) {
    axis.tangents = {low.value(), -high.value()};
    axis.close(slack);
  };
  take(lowU, highU, u_);
  take(lowV, highV, v_);
  const double radius = std::sqrt(points.x[0] * points.x[0] + points.y[0] * points.y[0] + points.z[0] * points.z[0]) *
                        points.scale * (1 - 1e-9);
  u_.circleRadius = radius * leastCircle(u_.tangents, v_.tangents);
  v_.circleRadius = radius * leastCircle(v_.tangents, u_.tangents);
  aroundAngles_ = 0;
}

CellRange FaceView::AxisView::cells(double outward, double within, double reach,
                                    std::uint32_t cellsPerFace) const noexcept {
  const double sine = reach / circleRadius;
  if (!(circleRadius > 0 && sine <= 0.5)) return cellsOfBall(middle, outward, within, cellsPerFace);
  const double margin = sine * (1 + 0.2 * sine * sine) / kRadians;  // asin(x) <= x (1 + 0.2 x^2) for x <= 1/2
  return cellsBetween(angles.low - margin, angles.high + margin, cellsPerFace);
}

CellBlock FaceView::cells(double reach, std::uint32_t cellsPerFace) const noexcept {
  const double within = ballRadius_ + reach;
  if (outward_ + within < 0) return {};
  return {u_.cells(outward_, within, aroundAngles_ + reach, cellsPerFace),
          v_.cells(outward_, within, aroundAngles_ + reach, cellsPerFace)};
}

bool FaceView::AxisView::isBeyond(const AngleSpan& at, double reach) const noexcept {
  const double off = std::max(angles.low - at.high, at.low - angles.high);
  if (!(off > 0 && off < 2)) return false;
  const double radians = off * kRadians;
  return circleRadius * radians * (1 - radians * radians * (1.0 / 6.0)) > reach;  // sin x >= x - x^3 / 6
}

bool FaceView::isBeyond(const AngleSpan& u, const AngleSpan& v, double reach) const noexcept {
  return u_.isBeyond(u, aroundAngles_ + reach) || v_.isBeyond(v, aroundAngles_ + reach);
}

bool FaceView::holds(const PointSet& points) const noexcept {
  if (aroundAngles_ > 0 || !(u_.circleRadius > 0)) return true;
  Least room;
  forEachOnFace(face_, points, [&](const Lanes& outward, const Lanes& u, const Lanes& v) {
    room.add(outward);
    room.add(u - u_.tangents.low * outward);
    room.add(u_.tangents.high * outward - u);
    room.add(v - v_.tangents.low * outward);
    room.add(v_.tangents.high * outward - v);
  });
  return room.value() >= 0;
}

PatchTarget::PatchTarget(const Ball& ball) noexcept
    : ball_(ball), views_{FaceView(0, ball), FaceView(1, ball), FaceView(2, ball),
                          FaceView(3, ball), FaceView(4, ball), FaceView(5, ball)} {}

PatchTarget::PatchTarget(const PointSet& points, double slack) noexcept
    : ball_(points.ball), views_{FaceView(0, points, slack), FaceView(1, points, slack), FaceView(2, points, slack),
                                 FaceView(3, points, slack), FaceView(4, points, slack), FaceView(5, points, slack)} {}

bool PatchTarget::touchedFrom(const double at[3], double scale, double reach) const noexcept {
  const double dx = at[0] * scale - ball_.center[0], dy = at[1] * scale - ball_.center[1],
               dz = at[2] * scale - ball_.center[2];
  const double limit = ball_.radius + reach;
  return dx * dx + dy * dy + dz * dz <= limit * limit;
}

bool PatchTarget::holds(const PointSet& points) const noexcept {
  const double limit = ball_.radius * ball_.radius;
  for (std::size_t i = 0; i < points.count; ++i) {
    const double dx = points.x[i] * points.scale - ball_.center[0], dy = points.y[i] * points.scale - ball_.center[1],
                 dz = points.z[i] * points.scale - ball_.center[2];
    if (!(dx * dx + dy * dy + dz * dz <= limit)) return false;
  }
  return std::all_of(views_.begin(), views_.end(), [&](const FaceView& view) { return view.holds(points); });
}

RowTarget::RowTarget(const PointSet& points) noexcept : patch_(points, 0) {
  const auto pointAt = [&](std::size_t index, double out[3]) {
    out[0] = points.x[index] * points.scale;
    out[1] = points.y[index] * points.scale;
    out[2] = points.z[index] * points.scale;
  };
  double end[3];
  pointAt(0, start_);
  pointAt(points.count - 1, end);
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    along_[a] = end[a] - start_[a];
    square += along_[a] * along_[a];
  }
  if (square > 0) inverseSquareLength_ = 1 / square;
  double farthest = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    double point[3];
    pointAt(i, point);
    farthest = std::max(farthest, squareDistanceFromLine(point));
  }
  bulge_ = std::sqrt(farthest) * (1 + 1e-9);
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

bool RowTarget::touchedFrom(const double at[3], double scale, double reach) const noexcept {
  const double point[3] = {at[0] * scale, at[1] * scale, at[2] * scale};
  const double limit = bulge_ + reach;
  return squareDistanceFromLine(point) <= limit * limit && patch_.touchedFrom(at, scale, reach);
}

}  // namespace terrane::lunar

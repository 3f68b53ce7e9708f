// Single directions: down the tree of triangles or squares, to the one of the surface's grid level that the direction
// is in.

#include <cmath>

#include "common/numerics/strict_math.h"
#include "server/fields/midpoint_samples.h"
#include "server/fields/midpoint_subdivision.h"

namespace terrane::midpoint {
namespace {

struct Sample {
  double heightMeters = 0;
  glm::dvec3 gradient{0.0};
};

using Corners = std::array<glm::dvec3, kTriangleCorners>;
constexpr std::size_t kCentreChild = 3;

/// From here on a triangle is flat: half its edges' angle, 2^-28, squared and halved is less than a double resolves, so
/// that weights by area are the map's.
constexpr int kFlatLevel = 28;

/// Twice the area of (a, b, d), positive to the left of the great circle from a to b; as differences, which are exact
/// where the three are close.
double leftOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& d) noexcept {
  return dot(cross(b - a, d - a), a);
}

std::size_t childAt(const Corners& corners, const glm::dvec3& direction, Corners& middles) noexcept {
  for (std::size_t k = 0; k < kTriangleCorners; ++k)
    middles[k] = normalised(corners[(k + 1) % 3] + corners[(k + 2) % 3]);
  for (std::size_t k = 0; k < kTriangleCorners; ++k)
    if (leftOf(middles[(k + 2) % 3], middles[(k + 1) % 3], direction) > 0) return k;
  return kCentreChild;
}

/// Weights of a direction at the corners of a triangle of that level, which is linear in them by the bisected map.
std::array<double, 3> weightsIn(const Corners& corners, int level, const glm::dvec3& direction) noexcept {
  std::array<double, 3> share{};
  if (level >= kFlatLevel) {
    for (std::size_t k = 0; k < 3; ++k)
      share[k] = std::fmax(0.0, leftOf(corners[(k + 1) % 3], corners[(k + 2) % 3], direction));
    const double sum = (share[0] + share[1]) + share[2];
    return {share[0] / sum, share[1] / sum, share[2] / sum};
  }
  Corners middles{};
  const std::size_t digit = childAt(corners, direction, middles);
  if (digit == kCentreChild) {
    const auto [a, b, c] = weightsIn(middles, level + 1, direction);
    return {0.5 * (b + c), 0.5 * (c + a), 0.5 * (a + b)};
  }
  Corners child = corners;
  const std::size_t next = (digit + 1) % 3, last = (digit + 2) % 3;
  child[next] = middles[last];
  child[last] = middles[next];
  const auto within = weightsIn(child, level + 1, direction);
  share[next] = 0.5 * within[next];
  share[last] = 0.5 * within[last];
  share[digit] = (within[digit] + share[next]) + share[last];
  return share;
}

Sample sampleTriangle(const Surface& surface, const glm::dvec3& direction) {
  thread_local Subdivision<IcoTiling<true>> subdivision;
  subdivision.start(surface.displacement, surface.gridLevel, icosahedronFaceAt(direction), 0);
  const auto corners = [&] {
    const Places& places = subdivision.places();
    return std::array{places.at(0, 0), places.at(1, 0), places.at(0, 1)};
  };
  auto [a, b, c] = corners();
  for (int level = 0; level < surface.gridLevel; ++level) {
    Corners middles{};
    subdivision.enterChild(static_cast<int>(childAt({a.direction, b.direction, c.direction}, direction, middles)));
    const auto below = corners();
    a = below[0], b = below[1], c = below[2];
  }
  const auto w = weightsIn({a.direction, b.direction, c.direction}, surface.gridLevel, direction);
  const glm::dvec3 ab = b.direction - a.direction, ac = c.direction - a.direction, up = cross(ab, ac);
  const glm::dvec3 turned = ac * (b.heightMeters - a.heightMeters) - ab * (c.heightMeters - a.heightMeters);
  return {(a.heightMeters * w[0] + b.heightMeters * w[1]) + c.heightMeters * w[2],
          cross(turned, up) / (surface.radiusMeters * dot(up, up))};
}

Sample sampleSquare(const Surface& surface, const glm::dvec3& direction) {
  thread_local Subdivision<CubeTiling> subdivision;
  const FaceCoordinates at = cubeFaceCoordinates(direction);
  subdivision.start(surface.displacement, surface.gridLevel, at.face, 0);
  double u = 0.5 * (at.s + 1.0), v = 0.5 * (at.t + 1.0);
  for (int level = 0; level < surface.gridLevel; ++level) {
    u *= 2.0;
    v *= 2.0;
    const int right = u >= 1.0 ? 1 : 0, up = v >= 1.0 ? 1 : 0;
    u -= right;
    v -= up;
    subdivision.enterChild(right + 2 * up);
  }
  const auto height = [&](int i, int j) { return subdivision.places().at(i, j).heightMeters; };
  const double low = height(0, 0) * (1.0 - u) + height(1, 0) * u, high = height(0, 1) * (1.0 - u) + height(1, 1) * u;

  // Along s and t, in which a cell is 2 / 2^gridLevel wide; their tangents but for what is along the direction, which
  // falls out of the products.
  const double perCell = std::ldexp(0.5, surface.gridLevel);
  const double alongS = perCell * ((height(1, 0) - height(0, 0)) * (1.0 - v) + (height(1, 1) - height(0, 1)) * v);
  const double alongT = perCell * (high - low);
  constexpr double kQuarterPi = 0.78539816339744831;
  const FaceAxes& axes = cubeFaceAxes(at.face);
  const double a = tanQuarterPi(at.s), b = tanQuarterPi(at.t), length = std::sqrt(1.0 + a * a + b * b);
  const glm::dvec3 tangentS = axes.u * (kQuarterPi * (1.0 + a * a) / length);
  const glm::dvec3 tangentT = axes.v * (kQuarterPi * (1.0 + b * b) / length);
  const glm::dvec3 gradient = cross(tangentT, direction) * alongS + cross(direction, tangentS) * alongT;
  return {low * (1.0 - v) + high * v, gradient / (surface.radiusMeters * dot(direction, cross(tangentS, tangentT)))};
}

}  // namespace

void sampleDirections(const Surface& surface, Scheme scheme, const SampleBatch& batch, SurfaceSamples& out) {
  for (std::size_t i = 0; i < batch.count(); ++i) {
    const glm::dvec3 direction(batch.x[i], batch.y[i], batch.z[i]);
    const Sample sample = scheme == Scheme::Ico ? sampleTriangle(surface, direction) : sampleSquare(surface, direction);
    out.heightMeters[i] = sample.heightMeters;
    out.gradientX[i] = static_cast<float>(sample.gradient.x);
    out.gradientY[i] = static_cast<float>(sample.gradient.y);
    out.gradientZ[i] = static_cast<float>(sample.gradient.z);
  }
}

}  // namespace terrane::midpoint

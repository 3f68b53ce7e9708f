#include "common/tiling/cube_sphere.h"

#include <array>
#include <cmath>

#include "common/numerics/strict_math.h"
#include "common/tiling/quarter_pi_polynomials.h"

namespace terrane {
namespace {

using V = glm::dvec3;
constexpr std::array<FaceAxes, 6> kFaceAxes{{
    {V(1, 0, 0), V(0, 1, 0), V(0, 0, 1)},
    {V(-1, 0, 0), V(0, -1, 0), V(0, 0, 1)},
    {V(0, 1, 0), V(-1, 0, 0), V(0, 0, 1)},
    {V(0, -1, 0), V(1, 0, 0), V(0, 0, 1)},
    {V(0, 0, 1), V(0, 1, 0), V(-1, 0, 0)},
    {V(0, 0, -1), V(0, 1, 0), V(1, 0, 0)},
}};

template <std::size_t N>
double horner(const std::array<double, N>& coefficients, double y) noexcept {
  double sum = coefficients[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * y + coefficients[i];
  return sum;
}

/// x (high + (low + x^2 P(x^2))).
template <std::size_t N>
double oddPolynomial(double high, double low, const std::array<double, N>& coefficients, double x) noexcept {
  const double y = x * x;
  return x * high + x * (y * horner(coefficients, y) + low);
}

}  // namespace

double tanQuarterPi(double x) noexcept {
  // tan(pi/4 - a) = (1 - tan a) / (1 + tan a) halves the range, and makes 1 exact. 1 - |x| is exact from 1/2 on.
  const double magnitude = std::fabs(x);
  const bool folded = magnitude > quarter_pi::kTangentRange;
  const double tangent = oddPolynomial(quarter_pi::kTangentHigh, quarter_pi::kTangentLow, quarter_pi::kTangent,
                                       folded ? 1.0 - magnitude : magnitude);
  return std::copysign(folded ? (1.0 - tangent) / (1.0 + tangent) : tangent, x);
}

double atanQuarterPi(double t) noexcept {
  // The same identity read the other way.
  const double magnitude = std::fabs(t);
  const bool folded = magnitude > quarter_pi::kArcTangentRange;
  const double angle = oddPolynomial(quarter_pi::kArcTangentHigh, quarter_pi::kArcTangentLow, quarter_pi::kArcTangent,
                                     folded ? (1.0 - magnitude) / (1.0 + magnitude) : magnitude);
  return std::copysign(folded ? 1.0 - angle : angle, t);
}

const FaceAxes& cubeFaceAxes(int face) noexcept { return kFaceAxes[static_cast<std::size_t>(face)]; }

glm::dvec3 cubeDirection(int face, double s, double t) noexcept {
  const FaceAxes& axes = cubeFaceAxes(face);
  // Each world component takes one term and two zeros, so nothing rounds here; the sum turns -0 into +0.
  const glm::dvec3 onCube = axes.normal + axes.u * tanQuarterPi(s) + axes.v * tanQuarterPi(t);
  // Always x, then y, then z: the faces that share this point must round alike.
  const double norm = std::sqrt((onCube.x * onCube.x + onCube.y * onCube.y) + onCube.z * onCube.z);
  return glm::dvec3(onCube.x / norm, onCube.y / norm, onCube.z / norm);
}

glm::dvec3 cubeGridDirection(int face, int gridLevel, std::uint64_t column, std::uint64_t row) noexcept {
  // 2 column - 2^gridLevel is an integer below 2^53 and the scale a power of two: exact.
  const double scale = std::ldexp(1.0, -gridLevel);
  const std::int64_t half = std::int64_t{1} << gridLevel;
  const double s = static_cast<double>(2 * static_cast<std::int64_t>(column) - half) * scale;
  const double t = static_cast<double>(2 * static_cast<std::int64_t>(row) - half) * scale;
  return cubeDirection(face, s, t);
}

FaceCoordinates cubeFaceCoordinates(const glm::dvec3& direction) noexcept {
  const glm::dvec3 magnitude(std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z));
  int face = std::signbit(direction.x) ? 1 : 0;
  double largest = magnitude.x;
  if (magnitude.y > largest) {
    face = std::signbit(direction.y) ? 3 : 2;
    largest = magnitude.y;
  }
  if (magnitude.z > largest) {
    face = std::signbit(direction.z) ? 5 : 4;
    largest = magnitude.z;
  }
  const FaceAxes& axes = cubeFaceAxes(face);
  const auto along = [&](const glm::dvec3& axis) {
    return axis.x * direction.x + axis.y * direction.y + axis.z * direction.z;
  };
  return FaceCoordinates{face, atanQuarterPi(along(axes.u) / largest), atanQuarterPi(along(axes.v) / largest)};
}

}  // namespace terrane

#include "tests/accuracy/projection/sphere_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"

namespace terrane::accuracy {
namespace {

using Vector = glm::dvec3;

/// Face coordinates in [-1, 1]^2 to a unit direction around +Z.
using Projection = Vector (*)(double s, double t);

Vector onSphere(double x, double y) { return glm::normalize(Vector(x, y, 1.0)); }

Vector gnomonic(double s, double t) { return onSphere(s, t); }

Vector equiangular(double s, double t) {
  constexpr double kQuarterPi = std::numbers::pi / 4;
  return onSphere(std::tan(kQuarterPi * s), std::tan(kQuarterPi * t));
}

Vector terrane(double s, double t) { return cubeDirection(4, s, t); }

/// Zucker and Higashi 2018, "Cube-to-sphere projections for procedural texturing and beyond", JCGT 7(2), section 3.1.
Vector tangentWarp(double s, double t) {
  constexpr double kTheta = 0.8687;
  static const double scale = 1 / std::tan(kTheta);
  return onSphere(scale * std::tan(kTheta * s), scale * std::tan(kTheta * t));
}

/// There, equation 14.
Vector everitt(double s, double t) {
  const auto warp = [](double x) {
    constexpr double kE = 1.4511;
    return std::copysign((kE - std::sqrt(kE * kE - 4 * (kE - 1) * std::fabs(x))) / (2 * (kE - 1)), x);
  };
  return onSphere(warp(s), warp(t));
}

/// Nowell 2005, "Mapping a cube to a sphere": no division, no normalising.
Vector nowell(double s, double t) {
  const double ss = s * s, tt = t * t;
  return {s * std::sqrt(1 - tt / 2 - 0.5 + tt / 3), t * std::sqrt(1 - ss / 2 - 0.5 + ss / 3),
          std::sqrt(1 - ss / 2 - tt / 2 + ss * tt / 3)};
}

/// The quadratic transform of the S2 geometry library.
Vector quadratic(double s, double t) {
  const auto warp = [](double x) {
    const double a = 1 + std::fabs(x);
    return std::copysign((a * a - 1) / 3, x);
  };
  return onSphere(warp(s), warp(t));
}

/// What cells and triangles are measured into.
class Shapes {
 public:
  explicit Shapes(double nominalWidth) : nominalWidth_(nominalWidth) {}

  /// Corners in order. Flat: they are of a small cell.
  void addCell(std::span<const Vector> corners) {
    const std::size_t count = corners.size();
    double area = 0, shortest = 1e9, longest = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vector &at = corners[k], &next = corners[(k + 1) % count], &last = corners[(k + count - 1) % count];
      const double edge = glm::length(next - at) / nominalWidth_;
      shortest = std::min(shortest, edge);
      longest = std::max(longest, edge);
      include(angleDegrees(at, next, last), shapes_.leastAngle, shapes_.mostAngle);
      if (k + 2 < count)
        area += 0.5 * glm::length(glm::cross(corners[k + 1] - corners[0], corners[k + 2] - corners[0]));
    }
    include(shortest, shapes_.shortestEdge, shapes_.longestEdge);
    include(longest, shapes_.shortestEdge, shapes_.longestEdge);
    include(area, smallestArea_, largestArea_);
    shapes_.longestForWidth = std::max(shapes_.longestForWidth, longest / shortest);
  }
  void addDrawn(const std::array<Vector, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k)
      include(angleDegrees(corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]), shapes_.leastDrawnAngle,
              shapes_.mostDrawnAngle);
  }
  CellShapes all() const {
    CellShapes all = shapes_;
    all.areaRatio = largestArea_ / smallestArea_;
    return all;
  }

 private:
  static void include(double value, double& least, double& most) {
    least = least == 0 ? value : std::min(least, value);
    most = std::max(most, value);
  }
  static double angleDegrees(const Vector& at, const Vector& p, const Vector& q) {
    const Vector u = p - at, v = q - at;
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * 180 / std::numbers::pi;
  }

  double nominalWidth_;
  double smallestArea_ = 0, largestArea_ = 0;
  CellShapes shapes_;
};

template <Projection kProject>
CellShapes cubeShapes(int n) {
  const auto at = [n](int i, int j) { return kProject(2.0 * i / n - 1, 2.0 * j / n - 1); };
  Shapes shapes(std::numbers::pi / 2 / n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const std::array<Vector, 4> cell{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      shapes.addCell(cell);
      shapes.addDrawn({cell[0], cell[1], cell[2]});
      shapes.addDrawn({cell[0], cell[2], cell[3]});
    }
  }
  return shapes.all();
}

template <IcoMap kMap>
CellShapes icoShapes(int n) {
  const auto size = static_cast<std::size_t>(triangleGridSize(n));
  std::vector<double> x(size), y(size), z(size);
  icoGridDirections(kMap, FacePath::wholeFace(Scheme::Ico, 0), n, {x, y, z});
  const auto at = [&](int i, int j) {
    const auto index = static_cast<std::size_t>(triangleGridIndex(n, {i, j}));
    return Vector(x[index], y[index], z[index]);
  };
  Shapes shapes(kIcosahedronEdgeAngle / n);
  const auto add = [&](const std::array<Vector, 3>& triangle) {
    shapes.addCell(triangle);
    shapes.addDrawn(triangle);
  };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      add({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < n) add({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return shapes.all();
}

Work cubePoints(Projection project) {
  return [project](std::size_t count) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double s = static_cast<double>(i % 1021) / 510.5 - 1, t = static_cast<double>(i % 769) / 384.5 - 1;
      const Vector p = project(s, t);
      sum += p.x + p.y * p.z;
    }
    return sum;
  };
}

/// Of a grid of 1024 cells.
Work icoPoints(IcoMap map) {
  return [map](std::size_t count) {
    constexpr int kGridLevel = 10;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto w0 = static_cast<std::int64_t>(i % 509), w1 = static_cast<std::int64_t>(i % 503);
      const Vector p = icoGridDirection(map, 0, kGridLevel, {w0, w1, (std::int64_t{1} << kGridLevel) - w0 - w1});
      sum += p.x + p.y * p.z;
    }
    return sum;
  };
}

template <Projection kProject>
SphereMap cubeMap(std::string_view name) {
  return {name, Scheme::Cube, cubeShapes<kProject>, cubePoints(kProject)};
}

std::vector<SphereMap> makeMaps() {
  return {cubeMap<gnomonic>("cube, gnomonic"),
          cubeMap<equiangular>("cube, equi-angular, libm tan"),
          {kCubeMapName, Scheme::Cube, cubeShapes<terrane>, cubePoints(terrane)},
          cubeMap<tangentWarp>("cube, tangent warp 0.8687"),
          cubeMap<everitt>("cube, Everitt 1.4511"),
          cubeMap<nowell>("cube, Nowell"),
          cubeMap<quadratic>("cube, quadratic (S2)"),
          {kBisectedMapName, Scheme::Ico, icoShapes<IcoMap::Bisected>, icoPoints(IcoMap::Bisected)},
          {kGnomonicMapName, Scheme::Ico, icoShapes<IcoMap::Gnomonic>, icoPoints(IcoMap::Gnomonic)}};
}

}  // namespace

std::span<const SphereMap> sphereMaps() {
  static const std::vector<SphereMap> maps = makeMaps();
  return maps;
}

}  // namespace terrane::accuracy

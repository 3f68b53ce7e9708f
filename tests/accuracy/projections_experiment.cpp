// Projections of a cube's face onto the sphere: how evenly each spreads a grid, and what a point costs.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "common/tiling/cube_sphere.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"

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

struct Named {
  const char* name;
  Projection project;
};
constexpr std::array<Named, 7> kProjections{{{"gnomonic", gnomonic},
                                             {"equi-angular, libm tan", equiangular},
                                             {"equi-angular, own tan (Terrane)", terrane},
                                             {"tangent warp 0.8687", tangentWarp},
                                             {"Everitt 1.4511", everitt},
                                             {"Nowell", nowell},
                                             {"quadratic (S2)", quadratic}}};

struct Distortion {
  double areaRatio = 0, worstAngleDegrees = 0, edgeRatio = 0, aspect = 0;
};

/// Over a grid of n x n cells of a face: the largest over the smallest area and edge, the corner furthest from a right
/// angle, and the longest cell for its width.
Distortion measure(Projection project, int n) {
  const auto at = [&](int i, int j) { return project(2.0 * i / n - 1, 2.0 * j / n - 1); };
  double leastArea = 1e9, mostArea = 0, leastEdge = 1e9, mostEdge = 0;
  Distortion d;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vector a = at(i, j), u = at(i + 1, j) - a, v = at(i, j + 1) - a, across = at(i + 1, j + 1) - a;
      const double area = 0.5 * (glm::length(glm::cross(u, across)) + glm::length(glm::cross(across, v)));
      const double lu = glm::length(u), lv = glm::length(v);
      leastArea = std::min(leastArea, area);
      mostArea = std::max(mostArea, area);
      leastEdge = std::min({leastEdge, lu, lv});
      mostEdge = std::max({mostEdge, lu, lv});
      const double angle = std::acos(glm::dot(u, v) / (lu * lv)) * 180 / std::numbers::pi;
      d.worstAngleDegrees = std::max(d.worstAngleDegrees, std::fabs(angle - 90));
      d.aspect = std::max({d.aspect, lu / lv, lv / lu});
    }
  }
  d.areaRatio = mostArea / leastArea;
  d.edgeRatio = mostEdge / leastEdge;
  return d;
}

Work pointsOf(Projection project) {
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

Report run(const Settings& settings, Progress& progress) {
  const int cells = settings.quick ? 256 : 1024;
  std::vector<Work> ways;
  for (const Named& named : kProjections) ways.push_back(pointsOf(named.project));
  const std::vector<double> times =
      nanosecondsPerItem(ways, settings.quick ? 20'000 : 200'000, settings.quick ? 7 : 25);

  Report report;
  report.columns = {{"projection", "projection"},
                    {"areaRatio", "area, largest / smallest"},
                    {"edgeRatio", "edge, longest / shortest"},
                    {"worstAngleDegrees", "worst angle from 90°, degrees"},
                    {"aspect", "longest cell, length / width"},
                    {"timeNsPerPoint", "time, ns a point"}};
  const Named* evenest = nullptr;
  double leastRatio = 1e9, gnomonicRatio = 0;
  for (std::size_t i = 0; i < kProjections.size(); ++i) {
    const Distortion d = measure(kProjections[i].project, cells);
    report.rows.push_back(
        {std::string(kProjections[i].name), d.areaRatio, d.edgeRatio, d.worstAngleDegrees, d.aspect, times[i]});
    if (i == 0) gnomonicRatio = d.areaRatio;
    if (d.areaRatio < leastRatio) {
      leastRatio = d.areaRatio;
      evenest = &kProjections[i];
    }
    progress.at(static_cast<double>(i + 1) / kProjections.size());
  }
  report.plots = {{"Unevenness over what a point costs", "timeNsPerPoint", "areaRatio", "projection", true, false}};
  report.findings = {fmt::format("The most even cells are those of {}: areas differ by {:.3f} where the gnomonic "
                                 "projection's differ by {:.3f}.",
                                 evenest->name, leastRatio, gnomonicRatio),
                     "Lines of constant coordinate are great circles in all but Nowell's, and only where both faces "
                     "compute the same bits on a "
                     "shared edge is there no seam: a tan of one's own that is exactly 1 at 1 buys that."};
  return report;
}

const Registration kRegistered(
    {90, "projections", "Cube to sphere",
     "How evenly do projections of a cube spread tiles over the sphere, and what does a point cost?", run});

}  // namespace
}  // namespace terrane::accuracy

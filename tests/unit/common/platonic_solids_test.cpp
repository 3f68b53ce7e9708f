// How round the five regular solids are: the share of the circumscribed sphere's radius at which the faces' planes lie.
// The rounder the solid, the less its faces are distorted on the sphere; the icosahedron's faces are as far out as the
// dodecahedron's, the furthest, and triangles at that.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <iostream>
#include <numbers>
#include <vector>

#include "common/tiling/icosahedron.h"

namespace terrane {
namespace {

using V = glm::dvec3;
constexpr double kPi = std::numbers::pi, kPhi = std::numbers::phi;

/// {p, q}: faces of p sides, q of them around a vertex.
struct Solid {
  const char* name;
  int p, q;
  std::vector<V> vertices;
  std::vector<V> face;  ///< three corners of one of its faces
  double printed;       ///< to three digits
};

std::vector<V> signsOf(const V& p) {
  std::vector<V> out;
  for (int bits = 0; bits < 8; ++bits)
    out.push_back(p * V((bits & 1) ? -1 : 1, (bits & 2) ? -1 : 1, (bits & 4) ? -1 : 1));
  return out;
}

std::vector<Solid> solids() {
  const V x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return {
      {"tetrahedron",
       3,
       3,
       {V(1, 1, 1), V(1, -1, -1), V(-1, 1, -1), V(-1, -1, 1)},
       {V(1, -1, -1), V(-1, 1, -1), V(-1, -1, 1)},
       0.333},
      {"cube", 4, 3, signsOf(V(1, 1, 1)), {V(1, 1, 1), V(-1, 1, 1), V(-1, -1, 1)}, 0.577},
      {"octahedron", 3, 4, {x, -x, y, -y, z, -z}, {x, y, z}, 0.577},
      {"dodecahedron", 5, 3, signsOf(V(1, 1, 1)), {V(1, 1, 1), V(0, 1 / kPhi, kPhi), V(0, -1 / kPhi, kPhi)}, 0.795},
      {"icosahedron", 3, 5, signsOf(V(0, 1, kPhi)), {V(0, 1, kPhi), V(kPhi, 0, 1), V(1, kPhi, 0)}, 0.795},
  };
}

/// Coxeter, "Regular Polytopes", section 2.4: 2R / 0R.
double coxetersRatio(int p, int q) { return 1.0 / (std::tan(kPi / p) * std::tan(kPi / q)); }

double measuredRatio(const Solid& solid) {
  const V normal = glm::normalize(glm::cross(solid.face[1] - solid.face[0], solid.face[2] - solid.face[0]));
  return std::fabs(glm::dot(normal, solid.face[0])) / glm::length(solid.vertices[0]);
}

TEST(PlatonicSolids, InradiusOverCircumradiusIsCoxetersForAllFive) {
  for (const Solid& solid : solids()) {
    const double ratio = coxetersRatio(solid.p, solid.q);
    std::cout << solid.name << " {" << solid.p << ", " << solid.q << "} " << ratio << '\n';
    EXPECT_NEAR(ratio, solid.printed, 0.0005) << solid.name;
    EXPECT_NEAR(measuredRatio(solid), ratio, 1e-15) << solid.name;
    for (const V& vertex : solid.vertices) EXPECT_NEAR(glm::length(vertex), glm::length(solid.vertices[0]), 1e-15);
  }
  EXPECT_NEAR(coxetersRatio(3, 5), kIcosahedronInradius, 1e-15);
  // The control: 0.56, which is in print for the cube and the octahedron, is no rounding of 1 / sqrt(3).
  EXPECT_GT(std::fabs(coxetersRatio(4, 3) - 0.56), 0.01);
}

}  // namespace
}  // namespace terrane

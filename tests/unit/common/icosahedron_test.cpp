#include "common/tiling/icosahedron.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <tuple>

namespace terrane {
namespace {

using V = glm::dvec3;

V centreOf(int face) {
  V sum(0.0);
  for (const int vertex : icosahedronCorners(face)) sum += icosahedronVertex(vertex);
  return glm::normalize(sum);
}

std::tuple<double, double, double> key(const V& p) { return {p.x, p.y, p.z}; }

TEST(Icosahedron, VerticesAreUnitVectorsThatNormalisingLeavesAsTheyAre) {
  for (int vertex = 0; vertex < kIcosahedronVertices; ++vertex) {
    const V p = icosahedronVertex(vertex);
    EXPECT_EQ((p.x * p.x + p.y * p.y) + p.z * p.z, 1.0) << vertex;
  }
}

TEST(Icosahedron, MirrorImagesAndCyclicPermutationsOfVerticesAreVerticesToTheBit) {
  std::set<std::tuple<double, double, double>> all;
  for (int vertex = 0; vertex < kIcosahedronVertices; ++vertex) all.insert(key(icosahedronVertex(vertex)));
  EXPECT_EQ(all.size(), 12u);
  for (int vertex = 0; vertex < kIcosahedronVertices; ++vertex) {
    const V p = icosahedronVertex(vertex);
    for (const V& image : {V(-p.x, p.y, p.z), V(p.x, -p.y, p.z), V(p.x, p.y, -p.z), V(p.y, p.z, p.x)})
      EXPECT_TRUE(all.contains(key(image))) << vertex;
  }
}

TEST(Icosahedron, FacesAreEquilateralCounterClockwiseAndCoverTheSphere) {
  std::set<std::set<int>> faces;
  double solidAngle = 0;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    const auto& corners = icosahedronCorners(face);
    faces.insert({corners[0], corners[1], corners[2]});
    const V a = icosahedronVertex(corners[0]), b = icosahedronVertex(corners[1]), c = icosahedronVertex(corners[2]);
    const double volume = glm::dot(glm::cross(a, b), c);
    EXPECT_GT(volume, 0) << "clockwise: " << face;
    for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}}) {
      EXPECT_NEAR(std::acos(glm::dot(p, q)), kIcosahedronEdgeAngle, 1e-15);
      solidAngle -= std::acos(-1.0) / 3;
    }
    EXPECT_NEAR(glm::dot(centreOf(face), a), kIcosahedronInradius, 1e-15);
    solidAngle += 2 * std::atan(volume / (1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a))) + std::acos(-1.0);
  }
  EXPECT_EQ(faces.size(), 20u);
  EXPECT_NEAR(solidAngle, 4 * std::acos(-1.0), 1e-13);
}

TEST(Icosahedron, EachOfThirtyEdgesIsSharedByTwoFacesThatRunAlongItInOppositeDirections) {
  std::map<std::set<int>, int> edges;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int edge = 0; edge < kTriangleCorners; ++edge) {
      const auto end = [](const FaceEdge& at, int which) {
        return icosahedronCorners(at.face)[static_cast<std::size_t>((at.edge + which) % kTriangleCorners)];
      };
      const FaceEdge own{face, edge}, beyond = beyondFaceEdge(face, edge);
      EXPECT_NE(beyond.face, face);
      EXPECT_EQ(end(own, 1), end(beyond, 2));
      EXPECT_EQ(end(own, 2), end(beyond, 1));
      EXPECT_EQ(beyondFaceEdge(beyond.face, beyond.edge), own);
      ++edges[{end(own, 1), end(own, 2)}];
    }
  }
  EXPECT_EQ(edges.size(), 30u);
  for (const auto& [ends, count] : edges) EXPECT_EQ(count, 2);
}

TEST(Icosahedron, FacesAndVerticesAreNumberedAsTheHeaderSays) {
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    const V centre = centreOf(face);
    const auto negative = [&](int axis) { return centre[axis] < -1e-9 ? 1 : 0; };
    if (face < 8) {
      EXPECT_EQ(face, 4 * negative(2) + 2 * negative(1) + negative(0));
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::fabs(centre[axis]), std::sqrt(1.0 / 3), 1e-15);
      continue;
    }
    const int axis = (face - 8) / 4, second = (axis + 1) % 3;
    EXPECT_EQ(face, 8 + 4 * axis + 2 * negative(axis) + negative(second));
    EXPECT_GT(std::fabs(centre[axis]), 0.9);
    EXPECT_NEAR(centre[(axis + 2) % 3], 0, 1e-16);
  }
  for (int vertex = 0; vertex < kIcosahedronVertices; ++vertex) {
    const V p = icosahedronVertex(vertex);
    const int axis = vertex / 4;
    EXPECT_EQ(p[axis], 0);
    EXPECT_EQ(vertex, 4 * axis + (p[(axis + 2) % 3] < 0 ? 2 : 0) + (p[(axis + 1) % 3] < 0 ? 1 : 0));
  }
}

/// How far inside of a face a direction of unit length is; negative outside.
double depthIn(int face, const V& direction) {
  double depth = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const V a = icosahedronVertex(icosahedronCorners(face)[k]);
    const V b = icosahedronVertex(icosahedronCorners(face)[(k + 1) % 3]);
    depth = std::min(depth, glm::dot(glm::normalize(glm::cross(a, b)), direction));
  }
  return depth;
}

TEST(Icosahedron, FaceAtIsTheFaceThatHoldsTheDirectionWhateverItsLength) {
  const std::uint64_t seed = 501;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::set<int> found;
  for (int i = 0; i < 20000; ++i) {
    V direction(normal(random), normal(random), normal(random));
    if (i % 4 == 0) direction[static_cast<int>(random() % 3)] = 0;
    const double length = std::ldexp(1.0, static_cast<int>(random() % 2000) - 1000);
    const int face = icosahedronFaceAt(direction * length);
    found.insert(face);
    ASSERT_GE(depthIn(face, glm::normalize(direction)), -1e-15);
  }
  EXPECT_EQ(found.size(), 20u);
}

TEST(Icosahedron, DirectionsOnBordersHaveOneAnswer) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double length : {1.0, 5e-324, 1e308}) {
      V direction(0.0);
      direction[axis] = length;
      EXPECT_EQ(icosahedronFaceAt(direction), 8 + 4 * axis) << "zero counts as positive";
      EXPECT_EQ(icosahedronFaceAt(-direction), 8 + 4 * axis + 2);
    }
  }
  for (int vertex = 0; vertex < kIcosahedronVertices; ++vertex) {
    const auto& corners = icosahedronCorners(icosahedronFaceAt(icosahedronVertex(vertex)));
    EXPECT_EQ(std::count(corners.begin(), corners.end(), vertex), 1);
  }
}

}  // namespace
}  // namespace terrane

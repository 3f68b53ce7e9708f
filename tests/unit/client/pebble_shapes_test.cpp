// The meshes of grains: closed, and each one the coarser one before its new vertices move.

#include "client/dust/pebble_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>

namespace terrane {
namespace {

glm::dvec3 directionOf(const PebbleVertex& v) { return {v.direction[0], v.direction[1], v.direction[2]}; }

TEST(PebbleShapes, EveryMeshIsClosedAndLooksOutwards) {
  for (int splits = 0; splits < 4; ++splits) {
    const PebbleMesh mesh = pebbleMesh(splits);
    EXPECT_EQ(mesh.triangles.size() / 3, 20u << (2 * splits));
    std::map<std::pair<int, int>, int> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
      const std::array<int, 3> corner{mesh.triangles[t], mesh.triangles[t + 1], mesh.triangles[t + 2]};
      std::array<glm::dvec3, 3> at;
      for (std::size_t k = 0; k < 3; ++k) {
        at[k] = directionOf(mesh.vertices[static_cast<std::size_t>(corner[k])]);
        ++edges[{corner[k], corner[(k + 1) % 3]}];
      }
      EXPECT_GT(glm::dot(glm::cross(at[1] - at[0], at[2] - at[0]), at[0] + at[1] + at[2]), 0);
    }
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_TRUE(edges.contains({edge.second, edge.first})) << "an open edge";
    }
    EXPECT_EQ(mesh.vertices.size(), 2 + edges.size() / 6) << "Euler";
  }
}

TEST(PebbleShapes, BeforeTheyMoveNewVerticesLieOnTheCoarserMeshsEdges) {
  for (int splits = 1; splits < 3; ++splits) {
    const PebbleMesh coarse = pebbleMesh(splits - 1), fine = pebbleMesh(splits);
    double worst = 0, farthestMoved = 0;
    for (std::size_t i = 0; i < fine.vertices.size(); ++i) {
      for (std::size_t shape = 0; shape < kGrainVariants; ++shape) {
        const PebbleVertex& vertex = fine.vertices[i];
        if (i < coarse.vertices.size()) {
          EXPECT_EQ(vertex.coarserRadii[shape], vertex.radii[shape]);
          EXPECT_EQ(vertex.radii[shape], coarse.vertices[i].radii[shape]);
          continue;
        }
        const glm::dvec3 at = directionOf(vertex) * static_cast<double>(vertex.coarserRadii[shape]);
        double nearest = 1;
        for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
          const std::size_t next = t % 3 == 2 ? t - 2 : t + 1;
          const PebbleVertex &a = coarse.vertices[coarse.triangles[t]], &b = coarse.vertices[coarse.triangles[next]];
          const glm::dvec3 p = directionOf(a) * static_cast<double>(a.radii[shape]),
                           q = directionOf(b) * static_cast<double>(b.radii[shape]);
          const double share = std::clamp(glm::dot(at - p, q - p) / glm::dot(q - p, q - p), 0.0, 1.0);
          nearest = std::min(nearest, glm::length(at - (p + share * (q - p))));
        }
        worst = std::max(worst, nearest);
        farthestMoved = std::max(farthestMoved, std::abs(1.0 * vertex.radii[shape] - vertex.coarserRadii[shape]));
      }
    }
    std::printf("%d splits: at most %.1e off an edge; they move by up to %.3f\n", splits, worst, farthestMoved);
    EXPECT_LE(worst, 4e-7);
    EXPECT_GT(farthestMoved, 0.02);
  }
}

TEST(PebbleShapes, OneSphereStandsForAll) {
  const PebbleMesh mesh = pebbleMesh(4);
  double sum = 0;
  for (const PebbleVertex& vertex : mesh.vertices)
    for (const float radius : vertex.radii) {
      EXPECT_GE(radius, 0.55f);
      EXPECT_LE(radius, 1.0f);
      sum += radius;
    }
  const double mean = sum / static_cast<double>(kGrainVariants * mesh.vertices.size());
  std::printf("mean radius %.4f\n", mean);
  EXPECT_NEAR(mean, kPebbleMeanRadius, 0.03);
}

}  // namespace
}  // namespace terrane

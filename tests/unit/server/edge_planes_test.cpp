#include "server/build/edge_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <glm/geometric.hpp>

#include "server/build/grid_directions.h"
#include "server/build/tile_topology.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

using namespace test;

constexpr unsigned kSeed = 65;
constexpr int kCells = 2;

class EdgePlanes : public OfScheme {};
INSTANTIATE_TEST_SUITE_P(Schemes, EdgePlanes, bothSchemes(), nameOfScheme);

TEST_P(EdgePlanes, SkirtsLeanOutOfBothPlanesAtACornerAndNoFartherThanBoundsMakeRoomFor) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  const auto topology = makeTileTopology(GetParam(), kCells);
  const std::size_t edges = topology->edgeCount();
  double farthest = 0;
  for (int round = 0; round < 400; ++round) {
    const int level = round % (maxLevel() + 1);
    FacePath path = randomTile(random, level);
    // Every fourth at a corner of its face, where edges meet at the sharpest angles.
    if (round % 4 == 0) {
      path = FacePath::wholeFace(GetParam(), path.face());
      while (path.level() < level) path = path.child(0);
    }
    GridDirections at;
    gridDirections(path, kCells, at);
    const auto end = [&](std::size_t edge, std::size_t k) {
      const std::uint32_t vertex = topology->skirtAnchors[edge * (kCells + 1) + k];
      return glm::dvec3(at.x[vertex], at.y[vertex], at.z[vertex]);
    };
    const auto outward = [&](std::size_t edge) {
      return glm::normalize(glm::cross(end(edge, kCells) - end(edge, 0), end(edge, 0)));
    };
    const EdgeNormals normals(path);
    for (std::size_t edge = 0; edge < edges; ++edge) {
      const glm::dvec3 lean = normals.lean(edge, kCells, kCells);
      EXPECT_EQ(lean, normals.lean((edge + 1) % edges, 0, kCells)) << path.text();
      EXPECT_NEAR(glm::dot(lean, outward(edge)), 1.0, 1e-5) << path.text();
      EXPECT_NEAR(glm::dot(lean, outward((edge + 1) % edges)), 1.0, 1e-5) << path.text();
      EXPECT_NEAR(glm::length(normals.lean(edge, 1, kCells) - outward(edge)), 0.0, 1e-6) << path.text();
      farthest = std::max(farthest, glm::length(lean));
    }
  }
  std::printf("farthest mitre: %.4f flares\n", farthest);
  EXPECT_LE(farthest, skirtCornerFlareSteps(GetParam()) / kSkirtFlareSteps);
  EXPECT_GT(farthest, 0.999 * skirtCornerFlareSteps(GetParam()) / kSkirtFlareSteps) << "more room than is needed";
}

}  // namespace
}  // namespace terrane

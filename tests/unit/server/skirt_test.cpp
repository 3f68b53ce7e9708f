// The skirts of built tiles of both schemes: where they hang, and that they close what opens between levels.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <vector>

#include "common/tiling/tile_neighbours.h"
#include "server/build/tile_topology.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

using namespace test;

constexpr unsigned kSeed = 64;
constexpr std::size_t kPerEdge = 65;

class Skirts : public OfScheme {
 protected:
  Skirts() : topology_(makeTileTopology(GetParam(), 64)), gridCount_(topology_->gridVertexCount()) {}

  /// An edge as skirts are ordered, of one that tile_neighbours.h counts.
  static std::size_t skirtEdge(int edge) {
    constexpr std::size_t kOfSide[] = {3, 1, 0, 2};
    return GetParam() == Scheme::Cube ? kOfSide[edge] : static_cast<std::size_t>(edge);
  }
  std::vector<glm::dvec3> edgeOf(const Tile& tile, int edge) const {
    std::vector<glm::dvec3> row;
    for (std::size_t k = 0; k < kPerEdge; ++k)
      row.push_back(position(tile, topology_->skirtAnchors[skirtEdge(edge) * kPerEdge + k]));
    return row;
  }
  std::vector<glm::dvec3> skirtOf(const Tile& tile, int edge) const {
    std::vector<glm::dvec3> row;
    for (std::size_t k = 0; k < kPerEdge; ++k)
      row.push_back(position(tile, gridCount_ + skirtEdge(edge) * kPerEdge + k));
    return row;
  }

  std::shared_ptr<const TileTopology> topology_;
  std::size_t gridCount_;
};
INSTANTIATE_TEST_SUITE_P(Grounds, Skirts, allGrounds(), nameOfGround);

TEST_P(Skirts, HangTowardsTheCentreLeaningALittleOutwards) {
  double farthest = 0;
  for (const char* text : {"1/2103", "4/333333", "0/1111"}) {
    const Tile tile = mesh(builder(), path(text));
    const double step = stepMeters(tile.metadata.stepExponent);
    double deepest = 0;
    for (std::size_t k = 0; k < topology_->skirtAnchors.size(); ++k) {
      const std::size_t vertex = gridCount_ + k, anchor = topology_->skirtAnchors[k];
      const glm::dvec3 edge = position(tile, anchor), bottom = position(tile, vertex);
      const double depth = glm::length(edge) - glm::length(bottom);
      EXPECT_GT(depth, step);
      EXPECT_LE(depth, static_cast<double>(tile.metadata.skirtMeters) + 2 * step);
      deepest = std::max(deepest, depth);
      // Both ends are rounded to the lattice: each is off by at most sqrt(3) / 2 steps.
      const glm::dvec3 lean = glm::normalize(bottom) - glm::normalize(edge);
      const std::uint32_t* ends = topology_->skirtAnchors.data() + k / kPerEdge * kPerEdge;
      const glm::dvec3 outwards = glm::normalize(glm::cross(position(tile, ends[64]), position(tile, ends[0])));
      EXPECT_GT(glm::dot(lean, outwards), 0.0) << "skirt vertex " << k;
      const bool corner = k % kPerEdge == 0 || k % kPerEdge == 64;
      const double flare = corner ? skirtCornerFlareSteps(GetParam()) : kSkirtFlareSteps;
      EXPECT_LE(glm::length(lean), (flare + 1.7321) * step / (kMoon + tile.metadata.heights.minMeters));
      farthest = std::max(farthest, glm::length(lean) * glm::length(bottom) / step);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(tile.mesh.normals[3 * anchor + axis], tile.mesh.normals[3 * vertex + axis]);
        EXPECT_EQ(tile.mesh.colors[3 * anchor + axis], tile.mesh.colors[3 * vertex + axis]);
      }
    }
    EXPECT_NEAR(deepest, static_cast<double>(tile.metadata.skirtMeters), 2 * step);
  }
  std::printf("farthest lean: %.2f steps\n", farthest);
}

TEST_P(Skirts, LeaveNoWedgeBetweenThoseOfTwoEdges) {
  for (const char* text : {"0", "3/0", "1/2103", "4/333333", "2/0123012301230123"}) {
    const Tile tile = mesh(builder(), path(text));
    for (std::size_t edge = 0; edge < topology_->edgeCount(); ++edge) {
      const std::size_t end = edge * kPerEdge + 64, start = (edge + 1) % topology_->edgeCount() * kPerEdge;
      EXPECT_EQ(position(tile, gridCount_ + end), position(tile, gridCount_ + start)) << text << " after edge " << edge;
    }
  }
}

/// A row of points as straight lines between them, met along the vertical of a direction; all in one plane with the
/// centre.
double lineHeight(const std::vector<glm::dvec3>& row, const glm::dvec3& direction) {
  const auto along = [&](const glm::dvec3& p) {
    return glm::dot(p, glm::normalize(row.back() - row.front())) /
           glm::dot(p, glm::normalize(row.front() + row.back()));
  };
  std::size_t next = 1;
  while (next + 1 < row.size() && along(row[next]) < along(direction)) ++next;
  const glm::dvec3 &a = row[next - 1], &b = row[next];
  const double t = (along(direction) - along(a)) / (along(b) - along(a));
  return glm::length(a + (b - a) * t) - kMoon;
}

/// The half of a coarser tile's edge that runs along a finer one's, in its order.
std::vector<glm::dvec3> halfAlong(std::vector<glm::dvec3> coarse, bool second) {
  std::reverse(coarse.begin(), coarse.end());
  return second ? std::vector(coarse.begin() + 32, coarse.end()) : std::vector(coarse.begin(), coarse.begin() + 33);
}

TEST_P(Skirts, OfTheHigherSideReachBelowTheLowerSidesEdgeWhereLevelsMeet) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  double deepest = 0;
  for (int round = 0; round < 60; ++round) {
    const int level = 1 + round % maxLevel();
    // A tile, and a coarser one beyond one of its edges, which must be a border of that one too.
    FacePath path = randomTile(random, level);
    int edge = static_cast<int>(random() % topology_->edgeCount());
    while (tileBeyondEdge(path, edge).parent() == path.parent()) {
      path = randomTile(random, level);
      edge = static_cast<int>(random() % topology_->edgeCount());
    }
    const FacePath beyond = tileBeyondEdge(path, edge).parent();
    int back = 0;
    while (tileBeyondEdge(beyond, back) != path.parent()) ++back;
    const Tile fine = mesh(builder(), path), coarse = mesh(builder(), beyond);
    const std::vector<glm::dvec3> fineEdge = edgeOf(fine, edge), fineSkirt = skirtOf(fine, edge);
    const std::vector<glm::dvec3> wholeEdge = edgeOf(coarse, back);
    const auto distance = [](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::length(glm::normalize(a) - glm::normalize(b));
    };
    const bool second = distance(fineEdge.front(), wholeEdge[32]) < distance(fineEdge.back(), wholeEdge[32]);
    const std::vector<glm::dvec3> coarseEdge = halfAlong(wholeEdge, second);
    const std::vector<glm::dvec3> coarseSkirt = halfAlong(skirtOf(coarse, back), second);
    const double cell = nominalTileWidthMeters(kMoon, level, GetParam()) / 64;
    ASSERT_LT(distance(fineEdge.front(), coarseEdge.front()) * kMoon, 0.01 * cell) << path.text();
    for (int k = 0; k <= 256; ++k) {
      const double share = std::clamp(k / 256.0, 1e-3, 1 - 1e-3);
      const glm::dvec3 direction = glm::normalize(fineEdge.front() * (1 - share) + fineEdge.back() * share);
      const double above = lineHeight(fineEdge, direction), below = lineHeight(coarseEdge, direction);
      EXPECT_LE(lineHeight(fineSkirt, direction), below) << path.text();
      EXPECT_LE(lineHeight(coarseSkirt, direction), above) << path.text();
    }
    deepest = std::max(deepest, static_cast<double>(fine.metadata.skirtMeters) / cell);
  }
  std::printf("deepest skirt: %.2f cells\n", deepest);
}

TEST_P(Skirts, TakeGroundForNoLessSteepThanItIs) {
  std::mt19937_64 random(kSeed);
  double steepest = 0;
  for (int level = 0; level <= maxLevel(); ++level) {
    const Tile tile = mesh(builder(), randomTile(random, level));
    for (std::size_t k = 0; k < 64; ++k) {
      const glm::dvec3 a = position(tile, k), b = position(tile, k + 1);
      steepest = std::max(steepest, std::abs(glm::length(a) - glm::length(b)) /
                                        (kMoon * glm::length(glm::normalize(a) - glm::normalize(b))));
    }
  }
  std::printf("steepest edge: %.2f\n", steepest);
  EXPECT_LE(steepest, kSteepestSlope);
}

}  // namespace
}  // namespace terrane

// Tiles and faces of the icosahedral sphere that share a vertex compute the very same bits for it, over all thirty
// edges and around all twelve vertices, by both maps. Beside it the usual ways that do not.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <set>
#include <vector>

#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/triangle_neighbours.h"
#include "tests/numeric/samples.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

using test::sameBits;
using V = glm::dvec3;
constexpr int kCells = 64;

struct Grid {
  std::vector<double> x, y, z;
  V at(const GridVertex& vertex) const {
    const auto index = static_cast<std::size_t>(triangleGridIndex(kCells, vertex));
    return {x[index], y[index], z[index]};
  }
  void set(const GridVertex& vertex, const V& d) {
    const auto index = static_cast<std::size_t>(triangleGridIndex(kCells, vertex));
    x[index] = d.x;
    y[index] = d.y;
    z[index] = d.z;
  }
};
using GridFunction = std::function<Grid(const FacePath&)>;

Grid emptyGrid() {
  const std::vector<double> zeros(static_cast<std::size_t>(triangleGridSize(kCells)));
  return {zeros, zeros, zeros};
}

GridFunction gridsOf(IcoMap map) {
  return [map](const FacePath& path) {
    Grid grid = emptyGrid();
    icoGridDirections(map, path, kCells, {grid.x, grid.y, grid.z});
    return grid;
  };
}

/// How many vertices of the borders to the three tiles beyond have other bits there.
struct Shared {
  int vertices = 0, differing = 0;
  double share() const { return static_cast<double>(differing) / vertices; }
};
void compareBorders(const GridFunction& gridOf, const FacePath& path, Shared& shared) {
  const Grid own = gridOf(path);
  for (int edge = 0; edge < 3; ++edge) {
    const TileEdge beyond = beyondEdge(path, edge);
    const Grid theirs = gridOf(beyond.tile);
    for (int k = 0; k <= kCells; ++k, ++shared.vertices)
      shared.differing +=
          !sameBits(own.at(edgeVertex(kCells, edge, k)), theirs.at(edgeVertex(kCells, beyond.edge, kCells - k)));
  }
}

/// Tiles of a level along all edges of all faces, the corners among them.
std::vector<FacePath> tilesAlongFaceEdges(std::mt19937_64& random, int level) {
  std::vector<FacePath> tiles;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int edge = 0; edge < 3; ++edge) {
      FacePath path = FacePath::wholeFace(Scheme::Ico, face);
      while (path.level() < level) path = path.child((edge + 1 + static_cast<int>(random() % 2)) % 3);
      tiles.push_back(path);
    }
    FacePath corner = FacePath::wholeFace(Scheme::Ico, face);
    while (corner.level() < level) corner = corner.child(face % 3);
    tiles.push_back(corner);
  }
  return tiles;
}

class IcoSharedVertices : public testing::TestWithParam<IcoMap> {};
INSTANTIATE_TEST_SUITE_P(Maps, IcoSharedVertices, testing::Values(IcoMap::Bisected, IcoMap::Gnomonic),
                         [](const auto& map) { return map.param == IcoMap::Bisected ? "Bisected" : "Gnomonic"; });

TEST_P(IcoSharedVertices, TilesBesideEachOtherComputeTheSameBitsAcrossAllFaceEdges) {
  std::mt19937_64 random = test::seededRandom(721);
  Shared shared;
  std::set<std::pair<int, int>> facePairs;
  for (const int level : {0, 1, 2, 5, 13, 22, 30}) {
    for (const FacePath& path : tilesAlongFaceEdges(random, level)) {
      compareBorders(gridsOf(GetParam()), path, shared);
      for (int edge = 0; edge < 3; ++edge) facePairs.insert({path.face(), beyondEdge(path, edge).tile.face()});
    }
    for (int i = 0; i < 20; ++i) compareBorders(gridsOf(GetParam()), test::randomIcoTile(random, level), shared);
  }
  EXPECT_EQ(shared.differing, 0) << "of " << shared.vertices;
  EXPECT_GE(facePairs.size(), 60u) << "30 edges, both ways";
  std::cout << shared.vertices << " shared vertices\n";
}

TEST_P(IcoSharedVertices, FiveFacesAgreeAtEachVertexOnDirectionAndLatticePosition) {
  int compared = 0;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int corner = 0; corner < 3; ++corner) {
      for (const int level : {0, 1, 2, 7, 18, FacePath::kMaxLevel}) {
        FacePath path = FacePath::wholeFace(Scheme::Ico, face);
        while (path.level() < level) path = path.child(corner);
        const auto around = tilesAroundCorner(path, corner);
        ASSERT_EQ(around.tiles().size(), 5u);
        const V own = icoCornerDirections(GetParam(), path)[static_cast<std::size_t>(corner)];
        for (const TileCorner& tile : around.tiles()) {
          const V theirs = icoCornerDirections(GetParam(), tile.tile)[static_cast<std::size_t>(tile.corner)];
          ASSERT_TRUE(sameBits(own, theirs)) << path.text() << " and " << tile.tile.text();
          for (const double radius : {kMinRadiusMeters, 1'737'400.0, 6'371'000.0, kMaxRadiusMeters}) {
            const int exponent = stepExponent(radius, level, Scheme::Ico);
            ASSERT_EQ(roundToLattice(own * radius, exponent), roundToLattice(theirs * radius, exponent));
          }
          ++compared;
        }
      }
    }
  }
  EXPECT_EQ(compared, 20 * 3 * 6 * 5);
}

V normalised(const V& p) {
  const double length = std::sqrt((p.x * p.x + p.y * p.y) + p.z * p.z);
  return V(p.x / length, p.y / length, p.z / length);
}

/// A control: from the face's corner 0 along the edges that begin there, by exact weights.
Grid alongTheEdgesOfTheFace(const FacePath& path) {
  Grid grid = emptyGrid();
  const TriangleTile tile = triangleTile(path);
  const auto& vertices = icosahedronCorners(path.face());
  const V origin = icosahedronVertex(vertices[0]);
  const V alongI = icosahedronVertex(vertices[1]) - origin, alongJ = icosahedronVertex(vertices[2]) - origin;
  const double unit = std::ldexp(1.0, -path.level() - 6);
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i + j <= kCells; ++i) {
      const FaceWeights w = gridVertexWeights(tile, kCells, {i, j});
      grid.set({i, j}, normalised(origin + alongI * (static_cast<double>(w.y) * unit) +
                                  alongJ * (static_cast<double>(w.z) * unit)));
    }
  }
  return grid;
}

/// A control: a tile's corners as bisected as here, then its grid row by row between them, as most do.
Grid interpolatedFromTheTilesCorners(const FacePath& path) {
  Grid grid = emptyGrid();
  const auto c = icoCornerDirections(IcoMap::Bisected, path);
  const V stepI = (c[1] - c[0]) * (1.0 / kCells), stepJ = (c[2] - c[0]) * (1.0 / kCells);
  for (int j = 0; j <= kCells; ++j) {
    V p = c[0] + stepJ * static_cast<double>(j);
    for (int i = 0; i + j <= kCells; ++i, p += stepI) {
      grid.set({i, j}, normalised(p));
    }
  }
  return grid;
}

/// A control: bisection by the usual interpolation, which depends on which end it starts from.
V interpolatedMiddle(const V& a, const V& b) { return normalised(a + (b - a) * 0.5); }
Grid bisectedByInterpolation(const FacePath& path) {
  std::array<V, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = icosahedronVertex(icosahedronCorners(path.face())[k]);
  for (int i = 0; i < path.level(); ++i) {
    const std::array<V, 3> parent = corners;
    const auto digit = static_cast<std::size_t>(path.digit(i));
    for (std::size_t k = 0; k < 3; ++k) {
      if (k != digit)
        corners[k] = interpolatedMiddle(parent[digit == 3 ? (k + 1) % 3 : digit], parent[digit == 3 ? (k + 2) % 3 : k]);
    }
  }
  Grid grid = emptyGrid();
  for (int edge = 0; edge < 3; ++edge)
    grid.set(edgeVertex(kCells, edge, 0), corners[static_cast<std::size_t>(edge + 1) % 3]);
  for (int half = kCells / 2; half > 0; half /= 2) {
    for (int j = 0; j <= kCells; j += half) {
      for (int i = 0; i + j <= kCells; i += half) {
        const int stepI = i & half, stepJ = (j & half) != 0 && stepI != 0 ? -half : j & half;
        if (stepI == 0 && stepJ == 0) continue;
        grid.set({i, j}, interpolatedMiddle(grid.at({i - stepI, j - stepJ}), grid.at({i + stepI, j + stepJ})));
      }
    }
  }
  return grid;
}

TEST(IcoSharedVerticesControl, SumsThatDependOnTheFaceDiffer) {
  std::mt19937_64 random = test::seededRandom(722);
  const std::vector<FacePath> tiles = tilesAlongFaceEdges(random, 3);
  const auto shareOf = [&](const char* name, const GridFunction& grids) {
    Shared shared;
    for (const FacePath& path : tiles) compareBorders(grids, path, shared);
    std::cout << name << ": " << shared.differing << " of " << shared.vertices << " shared vertices differ ("
              << 100 * shared.share() << " %)\n";
    return shared.share();
  };
  EXPECT_GT(shareOf("from the face's corner 0 along its edges", alongTheEdgesOfTheFace), 0.1);
  EXPECT_GT(shareOf("middles as a + (b - a) / 2", bisectedByInterpolation), 0.002);
  EXPECT_GT(shareOf("from the tile's corner 0 by steps", interpolatedFromTheTilesCorners), 0.5);
  EXPECT_EQ(shareOf("this library, bisected", gridsOf(IcoMap::Bisected)), 0.0);
  EXPECT_EQ(shareOf("this library, gnomonic", gridsOf(IcoMap::Gnomonic)), 0.0);
}

}  // namespace
}  // namespace terrane

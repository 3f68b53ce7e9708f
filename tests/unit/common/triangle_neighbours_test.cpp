#include "common/tiling/triangle_neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "common/tiling/triangle_tile.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

using test::allIcoTiles;
using test::randomIcoTile;
using test::SolidPoint;

/// A tile's corner as a point that all faces name alike.
SolidPoint cornerPoint(const FacePath& path, int corner) {
  return test::solidPoint(path.face(),
                          tileCorners(triangleTile(path))[static_cast<std::size_t>(corner % kTriangleCorners)]);
}

void expectSharedEdge(const FacePath& path, int edge) {
  const TileEdge beyond = beyondEdge(path, edge);
  ASSERT_NE(beyond.tile, path);
  ASSERT_EQ(beyond.tile.level(), path.level());
  ASSERT_EQ(cornerPoint(path, edge + 1), cornerPoint(beyond.tile, beyond.edge + 2)) << path.text() << ' ' << edge;
  ASSERT_EQ(cornerPoint(path, edge + 2), cornerPoint(beyond.tile, beyond.edge + 1)) << path.text() << ' ' << edge;
  ASSERT_EQ(beyondEdge(beyond.tile, beyond.edge), (TileEdge{path, edge})) << path.text();
  if (beyond.tile.face() == path.face()) {
    ASSERT_EQ(beyond.edge, edge);
  }
}

void expectRing(const FacePath& path, int corner) {
  const TilesAroundCorner around = tilesAroundCorner(path, corner);
  const auto tiles = around.tiles();
  const SolidPoint point = cornerPoint(path, corner);
  ASSERT_EQ(tiles.size(), point.size() == 1 ? 5u : 6u) << path.text() << ' ' << corner;
  ASSERT_EQ(tiles[0], (TileCorner{path, corner}));
  std::set<FacePath> distinct;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    distinct.insert(tiles[i].tile);
    ASSERT_EQ(cornerPoint(tiles[i].tile, tiles[i].corner), point) << path.text() << ' ' << corner;
    // Counter-clockwise: the edge that ends in the corner is where the next begins.
    const TileCorner& next = tiles[(i + 1) % tiles.size()];
    ASSERT_EQ(beyondEdge(tiles[i].tile, (tiles[i].corner + 1) % 3), (TileEdge{next.tile, (next.corner + 2) % 3}));
  }
  ASSERT_EQ(distinct.size(), tiles.size());
}

TEST(TriangleNeighbours, ShareTheirEdgeAndRunAlongItTheOtherWayOverAllThirtyFaceEdges) {
  std::set<std::pair<int, int>> facePairs;
  for (int level = 0; level <= 4; ++level) {
    for (const FacePath& path : allIcoTiles(level)) {
      for (int edge = 0; edge < 3; ++edge) {
        ASSERT_NO_FATAL_FAILURE(expectSharedEdge(path, edge));
        const int other = beyondEdge(path, edge).tile.face();
        if (other != path.face()) facePairs.insert({path.face(), other});
      }
    }
  }
  EXPECT_EQ(facePairs.size(), 60u) << "30 edges, both ways";
}

TEST(TriangleNeighbours, SixTilesLieAroundACornerInOrderAndFiveAroundTheTwelveVertices) {
  std::set<std::pair<int, int>> ofFive;  // vertex of the solid, level
  for (int level = 0; level <= 4; ++level) {
    for (const FacePath& path : allIcoTiles(level)) {
      for (int corner = 0; corner < 3; ++corner) {
        ASSERT_NO_FATAL_FAILURE(expectRing(path, corner));
        if (tilesAroundCorner(path, corner).tiles().size() == 5)
          ofFive.insert({cornerPoint(path, corner).begin()->first, level});
      }
    }
  }
  EXPECT_EQ(ofFive.size(), 12u * 5u) << "12 at each of 5 levels";
}

TEST(TriangleNeighbours, AreAllTilesThatTouchAndVerticesEdgesAndTilesMakeASphere) {
  for (int level = 0; level <= 4; ++level) {
    const std::vector<FacePath> tiles = allIcoTiles(level);
    std::map<SolidPoint, std::set<FacePath>> atPoint;
    std::set<std::set<SolidPoint>> edges;
    for (const FacePath& path : tiles) {
      for (int k = 0; k < 3; ++k) {
        atPoint[cornerPoint(path, k)].insert(path);
        edges.insert({cornerPoint(path, k + 1), cornerPoint(path, k + 2)});
      }
    }
    EXPECT_EQ(atPoint.size() + tiles.size(), edges.size() + 2) << "Euler";
    for (const FacePath& path : tiles) {
      for (int corner = 0; corner < 3; ++corner) {
        std::set<FacePath> named;
        const TilesAroundCorner around = tilesAroundCorner(path, corner);
        for (const TileCorner& tile : around.tiles()) named.insert(tile.tile);
        ASSERT_EQ(named, atPoint[cornerPoint(path, corner)]) << path.text();
      }
    }
  }
}

TEST(TriangleNeighbours, HoldDownToLevelThirtyAlsoAtFaceEdgesAndVertices) {
  const std::uint64_t seed = 611;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  int overFaceEdges = 0, atVertices = 0;
  for (int i = 0; i < 20000; ++i) {
    const FacePath path = randomIcoTile(random, i % 31);
    for (int k = 0; k < 3; ++k) {
      ASSERT_NO_FATAL_FAILURE(expectSharedEdge(path, k));
      ASSERT_NO_FATAL_FAILURE(expectRing(path, k));
      if (path.level() < 20) continue;
      overFaceEdges += beyondEdge(path, k).tile.face() != path.face();
      atVertices += tilesAroundCorner(path, k).tiles().size() == 5;
    }
  }
  std::cout << overFaceEdges << " over face edges, " << atVertices << " at vertices of five, at levels 20 to 30\n";
  EXPECT_GT(overFaceEdges, 500);
  EXPECT_GT(atVertices, 500);
}

TEST(TriangleNeighbours, TheCentreChildsAreItsThreeSiblings) {
  const std::uint64_t seed = 612;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (int i = 0; i < 2000; ++i) {
    const FacePath parent = randomIcoTile(random, i % 30);
    for (int edge = 0; edge < 3; ++edge)
      ASSERT_EQ(beyondEdge(parent.child(3), edge), (TileEdge{parent.child(edge), edge})) << parent.text();
  }
}

}  // namespace
}  // namespace terrane

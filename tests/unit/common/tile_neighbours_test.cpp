#include "common/tiling/tile_neighbours.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace terrane {
namespace {

constexpr unsigned kSeed = 11;

std::vector<FacePath> someTiles(Scheme scheme) {
  std::vector<FacePath> tiles;
  for (int face = 0; face < faceCount(scheme); ++face) {
    tiles.push_back(FacePath::wholeFace(scheme, face));
    for (int level = 1; level <= 3; ++level) {
      std::vector<FacePath> finer;
      for (const FacePath& tile : tiles)
        if (tile.face() == face && tile.level() == level - 1)
          for (int digit = 0; digit < 4; ++digit) finer.push_back(tile.child(digit));
      tiles.insert(tiles.end(), finer.begin(), finer.end());
    }
  }
  std::mt19937 random(kSeed);
  std::printf("seed %u\n", kSeed);
  for (int i = 0; i < 500; ++i) {
    FacePath tile = FacePath::wholeFace(scheme, static_cast<int>(random() % static_cast<unsigned>(faceCount(scheme))));
    for (auto level = random() % 31; level > 0; --level) tile = tile.child(static_cast<int>(random() % 4));
    tiles.push_back(tile);
  }
  return tiles;
}

class TileNeighbours : public testing::TestWithParam<Scheme> {};

TEST_P(TileNeighbours, TilesTouchEachOtherBothWays) {
  for (const FacePath& path : someTiles(GetParam())) {
    const TileList around = tilesAround(path);
    const std::set<FacePath> once(around.begin(), around.end());
    EXPECT_EQ(once.size(), around.tiles().size()) << path.text();
    EXPECT_FALSE(once.contains(path)) << path.text();
    for (const FacePath& tile : around) {
      EXPECT_EQ(tile.level(), path.level());
      const TileList back = tilesAround(tile);
      EXPECT_EQ(std::set<FacePath>(back.begin(), back.end()).count(path), 1u) << path.text() << " " << tile.text();
    }
  }
}

TEST_P(TileNeighbours, WhatIsAroundATileIsWhatIsAtItsCorners) {
  const int corners = edgeCount(GetParam());
  for (const FacePath& path : someTiles(GetParam())) {
    std::set<FacePath> atCorners, beyondEdges;
    for (int corner = 0; corner < corners; ++corner)
      for (const FacePath& tile : tilesAtCorner(path, corner)) atCorners.insert(tile);
    const TileList around = tilesAround(path);
    EXPECT_EQ(atCorners, std::set<FacePath>(around.begin(), around.end())) << path.text();
    for (int edge = 0; edge < corners; ++edge) beyondEdges.insert(tileBeyondEdge(path, edge));
    EXPECT_EQ(beyondEdges.size(), static_cast<std::size_t>(corners)) << path.text();
    for (const FacePath& tile : beyondEdges) EXPECT_TRUE(atCorners.contains(tile)) << path.text();
  }
}

TEST_P(TileNeighbours, ChildrenTouchOnlyWhatTheirParentsTouch) {
  for (const FacePath& path : someTiles(GetParam())) {
    if (path.level() == FacePath::kMaxLevel) continue;
    const TileList around = tilesAround(path);
    std::set<FacePath> touched(around.begin(), around.end());
    touched.insert(path);
    for (int digit = 0; digit < 4; ++digit)
      for (const FacePath& tile : tilesAround(path.child(digit)))
        EXPECT_TRUE(touched.contains(tile.parent())) << path.text() << " " << tile.text();
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, TileNeighbours, testing::Values(Scheme::Cube, Scheme::Ico),
                         [](const auto& scheme) { return std::string(schemeName(scheme.param)); });

}  // namespace
}  // namespace terrane

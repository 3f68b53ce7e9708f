// Keys of vertices are canonical over all faces and tiles; a hash of spherical angles, the control, is not.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "common/tiling/ico_sphere.h"
#include "tests/accuracy/welding/vertex_normals.h"
#include "tests/accuracy/welding/weld_counts.h"
#include "tests/support/ico_points.h"

namespace terrane::accuracy {
namespace {

constexpr unsigned kSeed = 7;

std::int64_t verticesOfSphere(int level) { return 10 * (std::int64_t{1} << (2 * level)) + 2; }

std::array<Weld, 4> exactWelds(const Soup& soup) {
  const std::vector<Corner> corners = cornersOf(soup);
  return {weldByKey64(corners), weldByKey64Radix(corners), weldByKey64HashTable(corners), weldByKey128(corners)};
}

/// Vertices of the surface by the solid's own vertices and weights, whatever the face.
Weld weldBySolidPoints(const Soup& soup) {
  std::map<test::SolidPoint, std::uint32_t> numbers;
  Weld weld;
  for (const Corner& corner : cornersOf(soup)) {
    const auto next = static_cast<std::uint32_t>(numbers.size());
    weld.vertexOfCorner.push_back(
        numbers.try_emplace(test::solidPoint(corner.face, corner.weights), next).first->second);
  }
  weld.count = static_cast<std::uint32_t>(numbers.size());
  return weld;
}

std::int64_t mistakes(const WeldCounts& counts) { return counts.missed.all() + counts.wrong.all(); }

TEST(Welding, ExactKeysFindTheVerticesOfTheWholeSphereAtEveryLevel) {
  for (int level = 0; level <= 5; ++level) {
    const Soup soup = wholeSphere(level);
    ASSERT_EQ(soup.corners(), 3u * 20u << (2 * level));
    const auto directions = positionsOf<double>(soup, Copies::Alike);
    const Weld truth = weldBySolidPoints(soup);
    EXPECT_EQ(truth.count, verticesOfSphere(level));
    for (const Weld& weld : exactWelds(soup)) EXPECT_EQ(mistakes(compare(weld, truth, directions)), 0) << level;
    EXPECT_EQ(mistakes(compare(weldByCoordinates(directions), truth, directions)), 0) << level;
  }
}

TEST(Welding, ExactKeysFindThemAroundTilesAtFacesEdgesAndVertices) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  for (const int level : {2, 9, 23}) {
    for (int n = 0; n < 20; ++n) {
      const Soup soup = tileWithNeighbours(test::randomIcoTile(random, level), 8);
      const auto directions = positionsOf<double>(soup, Copies::Alike);
      const Weld truth = weldBySolidPoints(soup);
      for (const Weld& weld : exactWelds(soup))
        EXPECT_EQ(mistakes(compare(weld, truth, directions)), 0) << soup.tiles.front().text();
    }
  }
  // Cells too deep for 64 bits.
  const Soup deepest = tileWithNeighbours(test::randomIcoTile(random, FacePath::kMaxLevel), 64);
  const auto directions = positionsOf<double>(deepest, Copies::Alike);
  EXPECT_EQ(mistakes(compare(weldByKey128(cornersOf(deepest)), weldBySolidPoints(deepest), directions)), 0);
}

TEST(Welding, TwelveVerticesHaveFiveTrianglesAndAllOthersSix) {
  const Soup soup = wholeSphere(4);
  const Weld weld = weldByKey64(cornersOf(soup));
  std::vector<int> triangles(weld.count);
  for (const std::uint32_t vertex : weld.vertexOfCorner) ++triangles[vertex];
  std::map<int, int> byCount;
  for (const int count : triangles) ++byCount[count];
  EXPECT_EQ(byCount, (std::map<int, int>{{5, 12}, {6, static_cast<int>(verticesOfSphere(4)) - 12}}));
}

TEST(Welding, KeysNameTwelveVerticesThirtyEdgesAndTwentyFaces) {
  constexpr int kLevel = 3, kWithinEdge = (1 << kLevel) - 1, kWithinFace = kWithinEdge * (kWithinEdge - 1) / 2;
  std::map<unsigned, std::set<Key128>> keysOfCell;
  std::set<std::uint64_t> narrow;
  for (const Corner& corner : cornersOf(wholeSphere(kLevel))) {
    const CellPoint point = cellPoint(corner.face, corner.weights);
    keysOfCell[point.cell].insert(key128(point));
    narrow.insert(key64(point));
  }
  std::map<std::size_t, int> cellsWithKeys;
  for (const auto& [cell, keys] : keysOfCell) ++cellsWithKeys[keys.size()];
  EXPECT_EQ(cellsWithKeys, (std::map<std::size_t, int>{{1, 12}, {kWithinEdge, 30}, {kWithinFace, 20}}));
  EXPECT_EQ(keysOfCell.rbegin()->first, kIcosahedronCells - 1);
  EXPECT_EQ(narrow.size(), static_cast<std::size_t>(verticesOfSphere(kLevel)));
}

TEST(Welding, TheFloatHashMergesDistinctVerticesWhateverTheEpsilon) {
  const Soup soup = wholeSphere(6);
  const auto directions = positionsOf<double>(soup, Copies::Alike);
  const Weld truth = weldByCoordinates(directions);
  for (const Copies copies : {Copies::Alike, Copies::Apart}) {
    const auto positions = positionsOf<float>(soup, copies);
    const auto sorted = sortedHashes<float>(positions, Sort::Introsort);
    EXPECT_FALSE(epsilonBounds<float>(sorted, truth, directions).possible());
    EXPECT_GT(compare(weldSorted<float>(sorted, 0), truth, directions).wrong.all(), 0);
  }
}

TEST(Welding, TheDoubleHashTearsTheAntimeridianWhereCopiesAreARoundingApart) {
  const Soup soup = wholeSphere(5);
  const auto directions = positionsOf<double>(soup, Copies::Alike);
  const Weld truth = weldByCoordinates(directions);
  const auto positions = positionsOf<double>(soup, Copies::Apart);
  const auto sorted = sortedHashes<double>(positions, Sort::Introsort);
  EXPECT_GT(compare(weldSorted<double>(sorted, kUsualEpsilon<double>), truth, directions).missed.seam, 0);
  const EpsilonBounds bounds = epsilonBounds<double>(sorted, truth, directions);
  EXPECT_FALSE(bounds.possible());
  EXPECT_GT(bounds.leastForNoMiss, bounds.leastForNoMissElsewhere);
}

TEST(Welding, TheFloatHashTearsThePolesWhereCopiesAreARoundingApart) {
  const Soup soup = tileWithNeighbours(icoTileAt(kIcoMap, {0, 0, 1}, 12), 64);
  const auto directions = positionsOf<double>(soup, Copies::Alike);
  const auto positions = positionsOf<float>(soup, Copies::Apart);
  const auto sorted = sortedHashes<float>(positions, Sort::Introsort);
  const Weld weld = weldSorted<float>(sorted, kUsualEpsilon<float>);
  EXPECT_GT(compare(weld, weldByCoordinates(directions), directions).missed.pole, 0);
}

TEST(Welding, EpsilonBoundsAreThoseAtWhichWeldsBeginToFail) {
  const Soup soup = wholeSphere(3);
  const auto directions = positionsOf<double>(soup, Copies::Alike);
  const Weld truth = weldByCoordinates(directions);
  const auto positions = positionsOf<double>(soup, Copies::Apart);
  const auto sorted = sortedHashes<double>(positions, Sort::Introsort);
  const EpsilonBounds bounds = epsilonBounds<double>(sorted, truth, directions);
  const auto at = [&](double epsilon) { return compare(weldSorted<double>(sorted, epsilon), truth, directions); };
  ASSERT_GT(bounds.leastForNoMiss, 0);
  EXPECT_EQ(at(bounds.leastForNoMiss).missed.all(), 0);
  EXPECT_GT(at(std::nextafter(bounds.leastForNoMiss, 0)).missed.all(), 0);
  EXPECT_GT(at(bounds.mostForNoWrong).wrong.all(), 0);
  EXPECT_EQ(at(std::nextafter(bounds.mostForNoWrong, 0)).wrong.all(), 0);
}

TEST(Welding, CountsAddUpAndSortsAgree) {
  const Soup soup = wholeSphere(6);
  const auto directions = positionsOf<double>(soup, Copies::Alike);
  const Weld truth = weldByCoordinates(directions);
  const auto positions = positionsOf<float>(soup, Copies::Apart);
  std::vector<WeldCounts> counts;
  for (const Sort sort : {Sort::Introsort, Sort::Heapsort})
    counts.push_back(
        compare(weldSorted<float>(sortedHashes<float>(positions, sort), kUsualEpsilon<float>), truth, directions));
  for (const WeldCounts& c : counts) EXPECT_EQ(c.found, c.truth + c.missed.all() - c.wrong.all());
  EXPECT_EQ(counts[0].found, counts[1].found);
  EXPECT_EQ(counts[0].missed.all(), counts[1].missed.all());
  EXPECT_EQ(counts[0].wrong.all(), counts[1].wrong.all());
}

TEST(Welding, SmoothNormalsOfAnExactWeldAgreeAtEveryCopyAndThoseOfTilesAloneDoNot) {
  const Soup soup = tileWithNeighbours(icoTileAt(kIcoMap, icosahedronVertex(0), 9), 16);
  const SoupGround ground = lunarGround(soup);
  const Weld weld = weldByKey64(cornersOf(soup));
  const auto exact = areaWeightedNormals(ground.positionsBody, weld);
  EXPECT_EQ(compareNormals(exact, exact, weld).mostOfCopies, 0);
  EXPECT_EQ(compareNormals(ground.gradientNormals, exact, weld).mostOfCopies, 0);
  const auto alone = areaWeightedNormals(ground.positionsBody, weldWithinTiles(soup));
  EXPECT_GT(compareNormals(alone, exact, weld).mostOfCopies, 0.1);
  // Of the right kind at all: near those of the ground's gradient.
  EXPECT_LT(compareNormals(exact, ground.gradientNormals, weld).mostOfExact, 20);
}

}  // namespace
}  // namespace terrane::accuracy

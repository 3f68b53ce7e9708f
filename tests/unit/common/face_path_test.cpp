#include "common/tiling/face_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <unordered_set>
#include <vector>

namespace terrane {
namespace {

constexpr std::array<Side, 4> kEdges{Side::UMin, Side::UMax, Side::VMin, Side::VMax};
constexpr std::array<Side, 4> kCorners{Side::UMinVMin, Side::UMaxVMin, Side::UMinVMax, Side::UMaxVMax};

using Point = std::array<std::int64_t, 3>;

// The face axes once more, written down from the table in face_path.h, so that the tests share nothing with the code.
constexpr std::array<std::array<Point, 3>, 6> kNormalUV{{
    {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}},
    {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}},
    {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}},
    {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}},
    {{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}},
}};

/// The corners of a tile as exact points of a cube of half-width 2^level: (u, v) = 00 10 01 11.
std::array<Point, 4> cornersOf(const FacePath& path) {
  const std::int64_t half = std::int64_t{1} << path.level();
  const auto& axes = kNormalUV[static_cast<std::size_t>(path.face())];
  std::array<Point, 4> corners{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::int64_t u = 2 * (static_cast<std::int64_t>(path.column()) + static_cast<std::int64_t>(i & 1)) - half;
    const std::int64_t v = 2 * (static_cast<std::int64_t>(path.row()) + static_cast<std::int64_t>(i >> 1)) - half;
    for (std::size_t k = 0; k < 3; ++k) corners[i][k] = half * axes[0][k] + u * axes[1][k] + v * axes[2][k];
  }
  return corners;
}

int sharedCorners(const FacePath& a, const FacePath& b) {
  int count = 0;
  for (const Point& p : cornersOf(a)) {
    for (const Point& q : cornersOf(b)) count += p == q ? 1 : 0;
  }
  return count;
}

std::vector<FacePath> allTiles(int level) {
  std::vector<FacePath> tiles;
  const std::uint32_t n = 1u << level;
  for (int face = 0; face < 6; ++face) {
    for (std::uint32_t row = 0; row < n; ++row) {
      for (std::uint32_t column = 0; column < n; ++column)
        tiles.push_back(FacePath::cubeTile(face, level, column, row));
    }
  }
  return tiles;
}

FacePath randomTile(std::mt19937_64& random, int level) {
  const std::uint32_t mask = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
  const int face = static_cast<int>(random() % 6);
  const std::uint32_t column = static_cast<std::uint32_t>(random()) & mask;
  return FacePath::cubeTile(face, level, column, static_cast<std::uint32_t>(random()) & mask);
}

std::string parseError(std::string_view text) {
  const Result<FacePath> path = FacePath::parse(text);
  if (path.has_value()) return "no error: " + path->text();
  EXPECT_EQ(path.error().kind, ErrorKind::InvalidArgument);
  EXPECT_FALSE(path.error().message.empty());
  return path.error().field;
}

TEST(FacePath, ReadsWhatItWrites) {
  for (const char* text : {"cube/0", "cube/5", "cube/2/0312", "cube/3/000000000000000000000000000000",
                           "cube/5/333333333333333333333333333333", "ico/0", "ico/19/0123", "ico/17/30012"}) {
    const Result<FacePath> path = FacePath::parse(text);
    ASSERT_TRUE(path.has_value()) << text << ": " << path.error().text();
    EXPECT_EQ(path->text(), text);
  }
  const std::uint64_t seed = 20240117;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (int i = 0; i < 20000; ++i) {
    const FacePath path = randomTile(random, static_cast<int>(random() % 31));
    const Result<FacePath> read = FacePath::parse(path.text());
    ASSERT_TRUE(read.has_value());
    ASSERT_EQ(*read, path);
    ASSERT_EQ(FacePath::fromParts("cube", std::to_string(path.face()), path.digits()).value(), path);
  }
}

TEST(FacePath, NamesTheFieldThatIsWrong) {
  EXPECT_EQ(parseError(""), "scheme");
  EXPECT_EQ(parseError("cub/1"), "scheme");
  EXPECT_EQ(parseError("CUBE/1"), "scheme");
  EXPECT_EQ(parseError("/1/0"), "scheme");
  EXPECT_EQ(parseError("cube"), "face");
  EXPECT_EQ(parseError("cube/"), "face");
  EXPECT_EQ(parseError("cube//0"), "face");
  EXPECT_EQ(parseError("cube/6/0"), "face");
  EXPECT_EQ(parseError("ico/20"), "face");
  EXPECT_EQ(parseError("cube/-1"), "face");
  EXPECT_EQ(parseError("cube/+1"), "face");
  EXPECT_EQ(parseError("cube/01"), "face") << "a tile has one name";
  EXPECT_EQ(parseError("cube/ 1"), "face");
  EXPECT_EQ(parseError("cube/18446744073709551617"), "face");
  EXPECT_EQ(parseError("cube/1/4"), "digits");
  EXPECT_EQ(parseError("cube/1/"), "digits");
  EXPECT_EQ(parseError("cube/1/01/2"), "digits");
  EXPECT_EQ(parseError("cube/1/01/"), "digits");
  EXPECT_EQ(parseError("cube/1/0 1"), "digits");
  EXPECT_EQ(parseError("cube/1/0000000000000000000000000000000"), "digits") << "31 digits are too deep";
}

TEST(FacePath, HostileTextGivesAShortPrintableError) {
  const std::uint64_t seed = 4242;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  const std::string alphabet("cubeico/0123456789./%\0\xff\n\"", 26);
  for (int i = 0; i < 4000; ++i) {
    std::string text = i % 2 ? "cube/1/" : "";
    const std::size_t length = i % 100 == 0 ? 100000 : random() % 48;
    for (std::size_t k = 0; k < length; ++k) text += alphabet[random() % alphabet.size()];
    const Result<FacePath> path = FacePath::parse(text);
    if (path.has_value()) {
      ASSERT_EQ(path->text(), text);  // one name for one tile, and nothing else is accepted
      continue;
    }
    ASSERT_LT(path.error().message.size(), 200u);
    for (const char c : path.error().message) ASSERT_TRUE(c >= 0x20 && c < 0x7f);
  }
}

TEST(FacePath, ChildrenAncestorsAndDigitsAgree) {
  const std::uint64_t seed = 99;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (int i = 0; i < 5000; ++i) {
    const FacePath path = randomTile(random, static_cast<int>(random() % 31));
    FacePath walked = FacePath::wholeFace(Scheme::Cube, path.face());
    for (int k = 0; k < path.level(); ++k) {
      ASSERT_EQ(path.ancestor(k), walked);
      walked = walked.child(path.digit(k));
      ASSERT_EQ(walked.parent(), path.ancestor(k));
      ASSERT_EQ(walked.column(), path.column() >> (path.level() - k - 1));
      ASSERT_EQ(walked.row(), path.row() >> (path.level() - k - 1));
    }
    ASSERT_EQ(walked, path);
    ASSERT_EQ(path.ancestor(path.level()), path);
    ASSERT_EQ(FacePath::cubeTile(path.face(), path.level(), path.column(), path.row()), path);
  }
}

TEST(FacePath, EdgeNeighboursShareTheTwoCornersOfThatEdgeExactly) {
  // Corners of a side among 00 10 01 11.
  const std::map<Side, std::array<std::size_t, 2>> edgeCorners{
      {Side::UMin, {0, 2}}, {Side::UMax, {1, 3}}, {Side::VMin, {0, 1}}, {Side::VMax, {2, 3}}};
  for (int level = 0; level <= 4; ++level) {
    for (const FacePath& tile : allTiles(level)) {
      const std::array<Point, 4> own = cornersOf(tile);
      for (const Side side : kEdges) {
        const std::optional<FacePath> other = tile.neighbour(side);
        ASSERT_TRUE(other.has_value());
        ASSERT_NE(*other, tile);
        ASSERT_EQ(other->level(), level);
        const std::array<Point, 4> theirs = cornersOf(*other);
        for (const std::size_t corner : edgeCorners.at(side)) {
          ASSERT_NE(std::find(theirs.begin(), theirs.end(), own[corner]), theirs.end())
              << tile.text() << " and " << other->text();
        }
        ASSERT_EQ(sharedCorners(tile, *other), 2);
      }
    }
  }
}

TEST(FacePath, NeighbourhoodIsSymmetricOverAllTwentyFourFaceEdges) {
  std::set<std::pair<int, int>> facePairs;
  for (int level = 0; level <= 4; ++level) {
    for (const FacePath& tile : allTiles(level)) {
      for (const Side side : kEdges) {
        const FacePath other = tile.neighbour(side).value();
        if (other.face() != tile.face()) facePairs.insert({tile.face(), other.face()});
        int back = 0;
        for (const Side returning : kEdges) back += other.neighbour(returning) == tile ? 1 : 0;
        ASSERT_EQ(back, 1) << tile.text() << " and " << other.text();
      }
      for (const Side side : kCorners) {
        const std::optional<FacePath> other = tile.neighbour(side);
        if (!other) continue;
        int back = 0;
        for (const Side returning : kCorners) back += other->neighbour(returning) == tile ? 1 : 0;
        ASSERT_EQ(back, 1) << tile.text() << " and " << other->text();
        ASSERT_EQ(sharedCorners(tile, *other), 1);
      }
    }
  }
  EXPECT_EQ(facePairs.size(), 24u);  // 12 edges, both ways: every face borders on all but its opposite
}

TEST(FacePath, NeighboursAreExactlyTheTilesThatTouch) {
  const int level = 3;
  const std::vector<FacePath> tiles = allTiles(level);
  std::map<Point, std::set<std::string>> atCorner;
  for (const FacePath& tile : tiles) {
    for (const Point& corner : cornersOf(tile)) atCorner[corner].insert(tile.text());
  }
  int cubeCorners = 0;
  for (const auto& [point, around] : atCorner) cubeCorners += around.size() == 3 ? 1 : 0;
  EXPECT_EQ(cubeCorners, 8);
  for (const FacePath& tile : tiles) {
    std::set<std::string> touching;
    for (const Point& corner : cornersOf(tile)) touching.insert(atCorner[corner].begin(), atCorner[corner].end());
    touching.erase(tile.text());
    std::set<std::string> named;
    int absent = 0;
    for (int side = 0; side < kSideCount; ++side) {
      const std::optional<FacePath> other = tile.neighbour(static_cast<Side>(side));
      if (other) {
        named.insert(other->text());
      } else {
        ++absent;
      }
    }
    ASSERT_EQ(named, touching) << tile.text();
    ASSERT_EQ(named.size() + static_cast<std::size_t>(absent), 8u);
    ASSERT_LE(absent, 1);
  }
}

TEST(FacePath, ADiagonalNeighbourIsTheSideNeighboursNeighbour) {
  const std::uint64_t seed = 7;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  int corners = 0;
  for (int i = 0; i < 20000; ++i) {
    const int level = 1 + static_cast<int>(random() % 30);
    const std::uint32_t last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
    // Half of them at the edges of their face, where it matters.
    FacePath tile = randomTile(random, level);
    const auto atEdge = [&](std::uint32_t x) { return random() % 2 ? x : (random() % 2 ? 0u : last); };
    const std::uint32_t column = atEdge(tile.column());
    tile = FacePath::cubeTile(tile.face(), level, column, atEdge(tile.row()));
    for (const Side side : kCorners) {
      const std::optional<FacePath> diagonal = tile.neighbour(side);
      const Side u = side == Side::UMinVMin || side == Side::UMinVMax ? Side::UMin : Side::UMax;
      const Side v = side == Side::UMinVMin || side == Side::UMaxVMin ? Side::VMin : Side::VMax;
      const FacePath overU = tile.neighbour(u).value();
      const FacePath overV = tile.neighbour(v).value();
      if (!diagonal) {
        ++corners;
        ASSERT_EQ(sharedCorners(overU, overV), 2) << "only three tiles meet at " << tile.text();
        continue;
      }
      // It has an edge in common with both side neighbours, and a corner alone with the tile.
      ASSERT_EQ(sharedCorners(*diagonal, overU), 2) << tile.text();
      ASSERT_EQ(sharedCorners(*diagonal, overV), 2) << tile.text();
      ASSERT_EQ(sharedCorners(*diagonal, tile), 1) << tile.text();
    }
  }
  EXPECT_GT(corners, 100);
}

TEST(FacePath, AWholeFaceHasFourNeighboursAndNoDiagonalOnes) {
  for (int face = 0; face < 6; ++face) {
    const FacePath path = FacePath::wholeFace(Scheme::Cube, face);
    std::set<int> around;
    for (const Side side : kEdges) around.insert(path.neighbour(side).value().face());
    EXPECT_EQ(around.size(), 4u);
    EXPECT_EQ(around.count(face), 0u);
    EXPECT_EQ(around.count(face ^ 1), 0u);
    for (const Side side : kCorners) EXPECT_FALSE(path.neighbour(side).has_value());
  }
}

TEST(FacePath, HashesOfAllTilesDownToLevelSixDiffer) {
  std::unordered_set<std::size_t> hashes;
  std::size_t count = 0;
  for (int level = 0; level <= 6; ++level) {
    for (const FacePath& tile : allTiles(level)) {
      hashes.insert(std::hash<FacePath>{}(tile));
      ++count;
    }
  }
  EXPECT_EQ(hashes.size(), count);
}

}  // namespace
}  // namespace terrane

// From a direction back to the tile that holds it, by both maps of the icosahedral sphere, at level 30.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <vector>

#include "common/tiling/ico_sphere.h"
#include "tests/numeric/samples.h"
#include "tests/support/ico_precise.h"

namespace terrane {
namespace {

using test::HighPrecision;
using test::PreciseVector;

class IcoTileAt : public testing::TestWithParam<IcoMap> {};
INSTANTIATE_TEST_SUITE_P(Maps, IcoTileAt, testing::Values(IcoMap::Bisected, IcoMap::Gnomonic),
                         [](const auto& map) { return map.param == IcoMap::Bisected ? "Bisected" : "Gnomonic"; });

/// How far outside of the tile's exact spherical triangle the direction lies, radians; negative inside.
double distanceOutside(IcoMap map, const FacePath& path, const glm::dvec3& direction) {
  const auto weights = tileCorners(triangleTile(path));
  std::array<PreciseVector, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = test::preciseDirection(map, path.face(), path.level(), weights[k]);
  const PreciseVector d = test::normalised(test::precise(direction));
  double outside = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const PreciseVector plane = test::normalised(test::cross(corners[k], corners[(k + 1) % 3]));
    outside = std::max(outside, -static_cast<double>(test::dot(plane, d)));
  }
  return outside;
}

glm::dvec3 centreOf(IcoMap map, const FacePath& path) {
  const auto corners = icoCornerDirections(map, path);
  return (corners[0] + corners[1]) + corners[2];
}

TEST_P(IcoTileAt, TheCentreOfATileFallsBackIntoIt) {
  std::mt19937_64 random = test::seededRandom(711);
  int lostInFloat = 0, deep = 0;
  for (int i = 0; i < 20000; ++i) {
    const FacePath path = test::randomIcoTile(random, i % 31);
    const glm::dvec3 centre = centreOf(GetParam(), path);
    const double length = std::ldexp(1.0, static_cast<int>(random() % 2000) - 1000);
    ASSERT_EQ(icoTileAt(GetParam(), centre * length, path.level()), path) << path.text();
    if (path.level() < 26) continue;
    ++deep;
    // The control: the direction kept in float.
    lostInFloat += icoTileAt(GetParam(), glm::dvec3(glm::vec3(centre)), path.level()) != path;
  }
  std::cout << "control, float: " << lostInFloat << " of " << deep << " in another tile at levels 26 to 30\n";
  EXPECT_GT(lostInFloat, deep * 9 / 10);
}

TEST_P(IcoTileAt, ATileOfLevelThirtyHoldsTheDirectionItWasFoundFor) {
  std::mt19937_64 random = test::seededRandom(712);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 1000; ++i) directions.emplace_back(normal(random), normal(random), normal(random));
  // On a plane of symmetry (some edges lie there), and vertices of grids, which lie on the borders of tiles.
  for (int i = 0; i < 500; ++i) {
    directions.emplace_back(normal(random), normal(random), normal(random));
    directions.back()[i % 3] = 0;
    const FacePath path = test::randomIcoTile(random, i % 31);
    for (const glm::dvec3& corner : icoCornerDirections(GetParam(), path)) directions.push_back(corner);
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      glm::dvec3 pole(0.0);
      pole[axis] = sign;
      directions.push_back(pole);
      for (const double off : {1e-16, -1e-16, 1e-9, -1e-9}) {
        directions.push_back(pole);
        directions.back()[(axis + 1) % 3] = off;
      }
    }
  }
  double worst = -1;
  for (const glm::dvec3& direction : directions) {
    const FacePath path = icoTileAt(GetParam(), direction, FacePath::kMaxLevel);
    ASSERT_EQ(path.level(), FacePath::kMaxLevel);
    const double outside = distanceOutside(GetParam(), path, direction);
    ASSERT_LE(outside, kIcoTileAtError) << path.text();
    worst = std::max(worst, outside);
    // A coarser answer is the ancestor of a finer one.
    const int level = static_cast<int>(random() % 30);
    ASSERT_EQ(icoTileAt(GetParam(), direction, level), path.ancestor(level));
  }
  std::cout << directions.size() << " directions: " << worst << " radians outside at most, bound " << kIcoTileAtError
            << "; a tile is 1e-9 wide\n";
}

TEST_P(IcoTileAt, ABorderWithTheCentreChildIsTheCentreChilds) {
  // The axis -y passes through the middle of the edge between faces 14 and 15: the lower face has it, and there it is a
  // corner of the centre child.
  const FacePath path = icoTileAt(GetParam(), glm::dvec3(0, -3, 0), 1);
  EXPECT_EQ(path.text(), "ico/14/3");
  // Directions whose place between corner child and centre child the arithmetic sees exactly.
  for (int face = 8; face < 20; ++face) {
    const glm::dvec3 axis = icoGridDirection(GetParam(), face, 1, FaceWeights(0, 1, 1));
    EXPECT_EQ(icoTileAt(GetParam(), axis, 1).digits(), "3");
  }
}

}  // namespace
}  // namespace terrane

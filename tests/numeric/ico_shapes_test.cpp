// How alike the tiles of the icosahedral sphere are, by both maps: areas, edges and angles, at the levels from which on
// they hardly change. What bounds and wall thicknesses elsewhere rest on.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <numbers>

#include "common/tiling/ico_sphere.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

using V = glm::dvec3;
constexpr double kPi = std::numbers::pi;

/// Over all tiles of a level. Edges in nominal widths (atan 2 / 2^level).
struct Shapes {
  double smallestArea = 1e300, largestArea = 0, sumOfAreas = 0;
  double shortestEdge = 1e300, longestEdge = 0;
  double smallestAngle = 1e300, largestAngle = 0;  ///< degrees
};

double angleBetween(const V& a, const V& b) { return 2 * std::asin(0.5 * glm::length(a - b)); }

Shapes measure(IcoMap map, int level) {
  Shapes shapes;
  const double width = std::ldexp(kIcosahedronEdgeAngle, -level);
  for (const FacePath& path : test::allIcoTiles(level)) {
    const auto c = icoCornerDirections(map, path);
    // van Oosterom and Strackee 1983; the determinant from differences, which keep its digits.
    const double determinant = glm::dot(c[0], glm::cross(c[1] - c[0], c[2] - c[0]));
    const double area =
        2 * std::atan2(determinant, 1 + glm::dot(c[0], c[1]) + glm::dot(c[1], c[2]) + glm::dot(c[2], c[0]));
    shapes.sumOfAreas += area;
    shapes.smallestArea = std::min(shapes.smallestArea, area);
    shapes.largestArea = std::max(shapes.largestArea, area);
    for (std::size_t k = 0; k < 3; ++k) {
      const V &at = c[k], &p = c[(k + 1) % 3], &q = c[(k + 2) % 3];
      const double edge = angleBetween(p, q) / width;
      shapes.shortestEdge = std::min(shapes.shortestEdge, edge);
      shapes.longestEdge = std::max(shapes.longestEdge, edge);
      // Of the spherical triangle: between the planes of the edges.
      const double angle =
          std::acos(glm::dot(glm::normalize(glm::cross(at, p - at)), glm::normalize(glm::cross(at, q - at))));
      shapes.smallestAngle = std::min(shapes.smallestAngle, angle * 180 / kPi);
      shapes.largestAngle = std::max(shapes.largestAngle, angle * 180 / kPi);
    }
  }
  return shapes;
}

void print(const char* map, int level, const Shapes& s) {
  std::cout << map << " level " << level << ": areas differ by " << s.largestArea / s.smallestArea << ", edges "
            << s.shortestEdge << " to " << s.longestEdge << " nominal widths, angles " << s.smallestAngle << " to "
            << s.largestAngle << " degrees\n";
}

TEST(IcoShapes, BisectedTilesDifferInAreaByOnePointThreeAndGnomonicByTwo) {
  // A small piece of a face at a distance r from the centre is (1 / r)^2 times cos(angle to the face's normal) as large
  // on the sphere: from the middle, r = the inradius, to a corner, r = 1.
  const double gnomonicLimit = std::pow(kIcosahedronInradius, -3);
  for (const int level : {6, 7}) {
    const Shapes bisected = measure(IcoMap::Bisected, level), gnomonic = measure(IcoMap::Gnomonic, level);
    EXPECT_NEAR(bisected.largestArea / bisected.smallestArea, 1.3005, 0.0005);
    EXPECT_LT(gnomonic.largestArea / gnomonic.smallestArea, gnomonicLimit);
    EXPECT_GT(gnomonic.largestArea / gnomonic.smallestArea, 0.98 * gnomonicLimit);
    for (const Shapes& shapes : {bisected, gnomonic}) EXPECT_NEAR(shapes.sumOfAreas, 4 * kPi, 1e-10);
  }
  std::cout << "limit of gnomonic tiles " << gnomonicLimit << '\n';
}

TEST(IcoShapes, EdgesAndAnglesAreWhatBoundsAndSkirtsRestOnAtAllLevels) {
  for (int level = 0; level <= 7; ++level) {
    const Shapes bisected = measure(IcoMap::Bisected, level), gnomonic = measure(IcoMap::Gnomonic, level);
    print("bisected", level, bisected);
    print("gnomonic", level, gnomonic);
    for (const Shapes& shapes : {bisected, gnomonic}) {
      EXPECT_LE(shapes.longestEdge, kIcoLongestEdge);
      EXPECT_GT(shapes.shortestEdge, 0.79);
      // Beside the twelve vertices, where five equal angles meet and the triangles are nearly flat.
      EXPECT_GE(shapes.smallestAngle, 54.0 - 1e-9);
      EXPECT_LE(shapes.largestAngle, 72.0 + 1e-9);
    }
  }
}

}  // namespace
}  // namespace terrane

// The places where a grid of longitudes and latitudes breaks, a pole and the antimeridian, are like any other here:
// tiles that touch them agree on their shared borders to the bit and have finite unit normals.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <numbers>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "server/build/tile_builder.h"
#include "tests/numeric/samples.h"
#include "tests/support/edge_vertices.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

using namespace testing_support;

constexpr double kPi = std::numbers::pi;
constexpr std::array<int, 6> kLevels{1, 2, 7, 14, 22, 30};

/// In float, u = 2^-24: of a sum of squares 3 u, of its root half that and u, of the reciprocal u, of each product u.
constexpr double kNormalLengthError = 4.5 * 0x1p-24 + 0x1p-46;

class TilesAround : public testing::Test {
 protected:
  Tile mesh(const FacePath& path) const {
    Result<Tile> tile = builder_.buildMesh(path);
    EXPECT_TRUE(tile.has_value()) << path.text();
    return tile.has_value() ? std::move(*tile) : Tile{};
  }

  /// The tile's borders against all four neighbours, and its normals.
  void check(const FacePath& path) {
    const Tile tile = mesh(path);
    for (int side = 0; side < kEdgeCount; ++side)
      expectSameEdge(tile, static_cast<Side>(side), mesh(*path.neighbour(static_cast<Side>(side))));
    for (std::size_t i = 0; i < tile.mesh.normals.size(); i += 3) {
      const glm::dvec3 normal(tile.mesh.normals[i], tile.mesh.normals[i + 1], tile.mesh.normals[i + 2]);
      const double error = std::fabs(glm::length(normal) - 1.0);
      ASSERT_LE(error, kNormalLengthError) << path.text() << " vertex " << i / 3;  // a NaN fails too
      worst_ = std::max(worst_, error);
    }
  }

  TileBuilder builder_{testMoon(), {.cellsPerEdge = 16, .draco = {}}, bestSimdPath()};
  double worst_ = 0;
};

TEST_F(TilesAround, APoleMeetInOneVertexAndHaveUnitNormals) {
  for (const int face : {4, 5}) {
    for (const int level : kLevels) {
      const std::uint32_t middle = 1u << (level - 1);
      std::vector<EdgeVertex> atPole;
      for (const std::uint32_t column : {middle - 1, middle}) {
        for (const std::uint32_t row : {middle - 1, middle}) {
          const FacePath path = FacePath::cubeTile(face, level, column, row);
          ASSERT_NO_FATAL_FAILURE(check(path));
          const std::vector<EdgeVertex> edge = edgeVertices(mesh(path), column < middle ? Side::UMax : Side::UMin);
          atPole.push_back(row < middle ? edge.back() : edge.front());
        }
      }
      for (const EdgeVertex& vertex : atPole) {
        EXPECT_EQ(vertex, atPole.front());
        EXPECT_EQ(vertex.point.x, 0);
        EXPECT_EQ(vertex.point.y, 0);
        EXPECT_EQ(vertex.point.z > 0, face == 4);
      }
    }
  }
  std::cout << "worst length of a normal: 1 +- " << worst_ << ", bound " << kNormalLengthError << '\n';
}

TEST_F(TilesAround, TheAntimeridianAgreeAcrossItAndHaveUnitNormals) {
  // The half plane y = 0, x < 0: the middle of face 1 from edge to edge, and half of the middle of faces 4 and 5.
  for (const int level : kLevels) {
    const std::uint32_t middle = 1u << (level - 1), last = (std::uint32_t{1} << level) - 1;
    for (const std::uint32_t column : {middle - 1, middle}) {
      for (const std::uint32_t row : {0u, middle / 2, middle, last})
        ASSERT_NO_FATAL_FAILURE(check(FacePath::cubeTile(1, level, column, row)));
      ASSERT_NO_FATAL_FAILURE(check(FacePath::cubeTile(4, level, column, last)));
      ASSERT_NO_FATAL_FAILURE(check(FacePath::cubeTile(5, level, column, 0)));
    }
  }
  std::cout << "worst length of a normal: 1 +- " << worst_ << ", bound " << kNormalLengthError << '\n';
}

/// The control: the usual sphere, columns by longitude and rows by latitude.
glm::dvec3 byLongitude(double longitude, double latitude) {
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

TEST(LongitudeGrid, HasNoNormalAtAPoleAndASeamAtTheAntimeridian) {
  // Half of the triangles of the row at a pole have both their upper corners there, so they have no area and no normal.
  // The pole itself must be exact for that; cos(pi / 2) is 6e-17.
  const glm::dvec3 pole(0, 0, 1);
  const auto corner = [&](double longitude, double latitude) {
    return latitude == kPi / 2 ? pole : byLongitude(longitude, latitude);
  };
  int withoutNormal = 0, torn = 0;
  const int columns = 64;
  for (int k = 0; k < columns; ++k) {
    const double west = kPi * (2.0 * k / columns - 1), east = kPi * (2.0 * (k + 1) / columns - 1);
    const glm::dvec3 a = corner(west, 1.5), b = corner(east, kPi / 2), c = corner(west, kPi / 2);
    withoutNormal += std::isnan(glm::normalize(glm::cross(b - a, c - a)).z);
    const double latitude = kPi * (static_cast<double>(k) / columns - 0.5);
    torn += !test::sameBits(byLongitude(-kPi, latitude), byLongitude(kPi, latitude));
  }
  EXPECT_EQ(withoutNormal, columns);
  EXPECT_EQ(torn, columns) << "sin(pi) and sin(-pi) differ";
}

}  // namespace
}  // namespace terrane

// A grid vertex has one name, whichever face and tile it is seen from, and no other vertex of its level has it.

#include "server/fields/midpoint_keys.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/triangle_neighbours.h"
#include "tests/support/ico_points.h"

namespace terrane {
namespace {

using KeyTuple = std::tuple<std::int64_t, std::int64_t, std::int64_t>;
KeyTuple tupleOf(const VertexKey& key) { return {key.a, key.b, key.c}; }

/// Each name to one point, and each point to one name.
template <class Point>
class OneToOne {
 public:
  void add(const VertexKey& key, const Point& point) {
    EXPECT_EQ(points_.try_emplace(tupleOf(key), point).first->second, point);
    EXPECT_EQ(keys_.try_emplace(point, tupleOf(key)).first->second, tupleOf(key));
  }
  std::size_t size() const { return points_.size(); }

 private:
  std::map<KeyTuple, Point> points_;
  std::map<Point, KeyTuple> keys_;
};

TEST(IcoVertexKeys, AreOneToAVertexOverAllFaces) {
  for (const int level : {0, 1, 2, 5}) {
    OneToOne<test::SolidPoint> names;
    const std::int64_t whole = std::int64_t{1} << level;
    for (int face = 0; face < kIcosahedronFaces; ++face) {
      for (std::int64_t j = 0; j <= whole; ++j)
        for (std::int64_t i = 0; i + j <= whole; ++i) {
          const FaceWeights weights(whole - i - j, i, j);
          names.add(icoVertexKey(face, weights), test::solidPoint(face, weights));
        }
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(10 * whole * whole + 2));  // Euler
  }
}

/// The places around each whole face, against the tiles that are there.
TEST(IcoVertexKeys, OfPlacesBeyondABorderAreThoseOfTheTilesBeyond) {
  const int level = 4;
  const std::int64_t whole = std::int64_t{1} << level;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int edge = 0; edge < kTriangleCorners; ++edge) {
      const FaceEdge beyond = beyondFaceEdge(face, edge);
      for (std::int64_t k = 0; k <= whole - 1; ++k) {
        // One step beyond the edge; k counts from corner edge + 1 on, and in the face beyond from corner edge + 2.
        FaceWeights mine(0), theirs(0);
        mine[edge] = theirs[beyond.edge] = -1;
        mine[(edge + 1) % 3] = whole - k;
        mine[(edge + 2) % 3] = k + 1;
        theirs[beyond.edge] = 1;
        theirs[(beyond.edge + 1) % 3] = k;
        theirs[(beyond.edge + 2) % 3] = whole - 1 - k;
        EXPECT_EQ(icoVertexKey(face, mine), icoVertexKey(beyond.face, theirs)) << face << " " << edge << " " << k;
      }
    }
  }
}

TEST(IcoVertexKeys, OfTheTwoPlacesBesideAVertexOfTheSolidAreOne) {
  const std::int64_t whole = 8;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int corner = 0; corner < kTriangleCorners; ++corner) {
      FaceWeights first(0), second(0);
      first[corner] = second[corner] = whole + 1;
      first[(corner + 1) % 3] = -1;
      second[(corner + 2) % 3] = -1;
      EXPECT_EQ(icoVertexKey(face, first), icoVertexKey(face, second));
      // And it lies on the fifth edge: between the third and the fourth of the five faces there.
      const TilesAroundCorner corners = tilesAroundCorner(FacePath::wholeFace(Scheme::Ico, face), corner);
      const auto around = corners.tiles();
      ASSERT_EQ(around.size(), 5u);
      FaceWeights there(0);
      there[around[2].corner] = whole - 1;
      there[(around[2].corner + 2) % 3] = 1;
      EXPECT_EQ(icoVertexKey(around[2].tile.face(), there), icoVertexKey(face, first)) << face << " " << corner;
    }
  }
}

TEST(CubeVertexKeys, AreOneToAVertexOverAllFaces) {
  for (const int level : {0, 1, 2, 5}) {
    OneToOne<std::tuple<double, double, double>> names;
    const std::uint64_t whole = std::uint64_t{1} << level;
    for (int face = 0; face < 6; ++face) {
      for (std::uint64_t row = 0; row <= whole; ++row)
        for (std::uint64_t column = 0; column <= whole; ++column) {
          const glm::dvec3 d = cubeGridDirection(face, level, column, row);
          names.add(cubeVertexKey(face, level, static_cast<std::int64_t>(column), static_cast<std::int64_t>(row)),
                    {d.x, d.y, d.z});
        }
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(6 * whole * whole + 2));
  }
}

TEST(CubeVertexKeys, OfPlacesBeyondABorderAreThoseOfTheTilesBeyond) {
  const int level = 3;
  const std::int64_t whole = std::int64_t{1} << level;
  for (int face = 0; face < 6; ++face) {
    std::set<KeyTuple> ofFace;
    for (std::int64_t row = 0; row <= whole; ++row)
      for (std::int64_t column = 0; column <= whole; ++column)
        ofFace.insert(tupleOf(cubeVertexKey(face, level, column, row)));
    for (std::int64_t k = 0; k < whole; ++k) {
      const auto at = static_cast<std::uint32_t>(k), last = static_cast<std::uint32_t>(whole - 1);
      const FacePath beyond = *FacePath::cubeTile(face, level, last, at).neighbour(Side::UMax);
      std::set<KeyTuple> expected;
      for (int corner = 0; corner < 4; ++corner)
        expected.insert(
            tupleOf(cubeVertexKey(beyond.face(), level, beyond.column() + (corner & 1), beyond.row() + (corner >> 1))));
      std::erase_if(expected, [&](const KeyTuple& key) { return ofFace.contains(key); });
      EXPECT_EQ((std::set{tupleOf(cubeVertexKey(face, level, whole + 1, k)),
                          tupleOf(cubeVertexKey(face, level, whole + 1, k + 1))}),
                expected);
    }
    // The two places beside a corner of the cube.
    EXPECT_EQ(cubeVertexKey(face, level, -1, 0), cubeVertexKey(face, level, 0, -1));
    EXPECT_EQ(cubeVertexKey(face, level, whole + 1, whole), cubeVertexKey(face, level, whole, whole + 1));
    EXPECT_FALSE(ofFace.contains(tupleOf(cubeVertexKey(face, level, -1, 0))));
  }
}

}  // namespace
}  // namespace terrane

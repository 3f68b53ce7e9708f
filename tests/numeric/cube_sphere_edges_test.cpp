// Where cube faces meet, they compute the very same bits: on all twelve edges and in all eight corners, however fine
// the grid. Beside it the two usual ways that do not.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <random>
#include <vector>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "tests/numeric/samples.h"

namespace terrane {
namespace {

using test::sameBits;

/// A vertex of a face grid as a point of the cube of half-width 2^gridLevel.
std::array<std::int64_t, 3> cubePoint(int face, int gridLevel, std::uint64_t column, std::uint64_t row) {
  const std::int64_t half = std::int64_t{1} << gridLevel;
  const FaceAxes& axes = cubeFaceAxes(face);
  std::array<std::int64_t, 3> point{};
  for (int k = 0; k < 3; ++k) {
    point[static_cast<std::size_t>(k)] =
        static_cast<std::int64_t>(axes.normal[k]) * half +
        static_cast<std::int64_t>(axes.u[k]) * (2 * static_cast<std::int64_t>(column) - half) +
        static_cast<std::int64_t>(axes.v[k]) * (2 * static_cast<std::int64_t>(row) - half);
  }
  return point;
}

struct FaceVertex {
  int face;
  std::uint64_t column, row;
};

/// Every face that holds the point, with its own grid coordinates of it.
std::vector<FaceVertex> facesAt(const std::array<std::int64_t, 3>& point, int gridLevel) {
  const std::int64_t half = std::int64_t{1} << gridLevel;
  std::vector<FaceVertex> out;
  for (int face = 0; face < 6; ++face) {
    const FaceAxes& axes = cubeFaceAxes(face);
    const auto along = [&](const glm::dvec3& axis) {
      return static_cast<std::int64_t>(axis.x) * point[0] + static_cast<std::int64_t>(axis.y) * point[1] +
             static_cast<std::int64_t>(axis.z) * point[2];
    };
    if (along(axes.normal) != half) continue;
    out.push_back({face, static_cast<std::uint64_t>((along(axes.u) + half) / 2),
                   static_cast<std::uint64_t>((along(axes.v) + half) / 2)});
  }
  return out;
}

using DirectionFunction = std::function<glm::dvec3(int face, int gridLevel, std::uint64_t column, std::uint64_t row)>;

/// How many of the shared vertices of all face edges come out with different bits on different faces.
struct SharedCount {
  int vertices = 0, cubeCorners = 0, differing = 0;
  double share() const { return static_cast<double>(differing) / vertices; }
};
SharedCount compareSharedVertices(const DirectionFunction& direction, int gridLevel,
                                  const std::vector<std::uint64_t>& positions) {
  SharedCount count;
  const std::uint64_t last = std::uint64_t{1} << gridLevel;
  for (int face = 0; face < 6; ++face) {
    for (const std::uint64_t at : positions) {
      for (const auto& [column, row] : {std::pair{at, std::uint64_t{0}}, std::pair{at, last},
                                        std::pair{std::uint64_t{0}, at}, std::pair{last, at}}) {
        const std::vector<FaceVertex> shared = facesAt(cubePoint(face, gridLevel, column, row), gridLevel);
        EXPECT_GE(shared.size(), 2u);
        ++count.vertices;
        if (shared.size() == 3) ++count.cubeCorners;
        const glm::dvec3 own = direction(face, gridLevel, column, row);
        bool differs = false;
        for (const FaceVertex& other : shared) {
          differs = differs || !sameBits(own, direction(other.face, gridLevel, other.column, other.row));
        }
        count.differing += differs ? 1 : 0;
      }
    }
  }
  return count;
}

std::vector<std::uint64_t> allPositions(int gridLevel) {
  std::vector<std::uint64_t> positions;
  for (std::uint64_t i = 0; i <= (std::uint64_t{1} << gridLevel); ++i) positions.push_back(i);
  return positions;
}

/// -1 .. 1 along a face.
double faceCoordinate(int gridLevel, std::uint64_t line) {
  return static_cast<double>(line) * std::ldexp(2.0, -gridLevel) - 1.0;
}

glm::dvec3 directionWith(int face, double a, double b, bool worldOrder) {
  const FaceAxes& axes = cubeFaceAxes(face);
  const glm::dvec3 p = axes.normal + axes.u * a + axes.v * b;
  const double norm = worldOrder ? std::sqrt((p.x * p.x + p.y * p.y) + p.z * p.z) : std::sqrt((1.0 + a * a) + b * b);
  return glm::dvec3(p.x / norm, p.y / norm, p.z / norm);
}

/// The control: the C library's tangent, which ends at 0.9999999999999999 and not at 1.
glm::dvec3 withLibraryTangent(int face, int gridLevel, std::uint64_t column, std::uint64_t row) {
  const double quarterPi = 0.78539816339744831;
  return directionWith(face, std::tan(faceCoordinate(gridLevel, column) * quarterPi),
                       std::tan(faceCoordinate(gridLevel, row) * quarterPi), true);
}

/// The control: the norm summed as 1 + a^2 + b^2, which adds the same squares in another order on another face.
glm::dvec3 normalisedInFaceOrder(int face, int gridLevel, std::uint64_t column, std::uint64_t row) {
  return directionWith(face, tanQuarterPi(faceCoordinate(gridLevel, column)),
                       tanQuarterPi(faceCoordinate(gridLevel, row)), false);
}

TEST(CubeSphere, FacesThatShareAVertexComputeTheSameBits) {
  const SharedCount coarse = compareSharedVertices(cubeGridDirection, 8, allPositions(8));
  EXPECT_EQ(coarse.differing, 0) << "of " << coarse.vertices;
  EXPECT_EQ(coarse.cubeCorners, 6 * 8) << "8 corners, seen from 3 faces, each along two edges";

  std::mt19937_64 random = test::seededRandom(104);
  for (const int gridLevel : {0, 1, 17, 36, 52}) {
    const std::uint64_t last = std::uint64_t{1} << gridLevel;
    std::vector<std::uint64_t> positions{0, last / 2, last};
    for (int i = 0; i < 500; ++i) positions.push_back(random() % (last + 1));
    EXPECT_EQ(compareSharedVertices(cubeGridDirection, gridLevel, positions).differing, 0) << gridLevel;
  }
}

TEST(CubeSphere, TanOfAQuarterPiIsForcedToOneSoThatEdgesAgree) {
  EXPECT_TRUE(sameBits(tanQuarterPi(1.0), 1.0));
  EXPECT_TRUE(sameBits(tanQuarterPi(-1.0), -1.0));
  const volatile double quarterPi = 0.78539816339744831;
  EXPECT_EQ(std::tan(quarterPi), std::nextafter(1.0, 0.0)) << "the control: the C library's";

  const SharedCount control = compareSharedVertices(withLibraryTangent, 8, allPositions(8));
  std::cout << "control, std::tan: " << control.differing << " of " << control.vertices << " shared vertices differ ("
            << 100 * control.share() << " %)\n";
  EXPECT_GT(control.share(), 0.5) << "two thirds, give or take what the CPU does to std::tan's last bits";
}

TEST(CubeSphere, NormsAreSummedInWorldAxisOrderSoThatEdgesAgree) {
  const auto sumInFaceOrder = [](int, int gridLevel, std::uint64_t column, std::uint64_t row) {
    const double a = tanQuarterPi(faceCoordinate(gridLevel, column)), b = tanQuarterPi(faceCoordinate(gridLevel, row));
    return glm::dvec3((1.0 + a * a) + b * b, 0, 0);
  };
  const SharedCount sums = compareSharedVertices(sumInFaceOrder, 8, allPositions(8));
  const SharedCount directions = compareSharedVertices(normalisedInFaceOrder, 8, allPositions(8));
  std::cout << "control, norm in face order: at " << 100 * sums.share() << " % of " << sums.vertices
            << " shared vertices the sums differ, at " << 100 * directions.share() << " % the directions still do\n";
  EXPECT_GT(sums.share(), 0.03);
  EXPECT_GT(directions.share(), 0.01);
}

/// The corner's direction on each of the three faces that meet there. Bit k of corner: towards +axis k.
std::vector<glm::dvec3> atCubeCorner(const DirectionFunction& direction, int corner, int gridLevel) {
  const std::int64_t half = std::int64_t{1} << gridLevel;
  const auto toward = [&](int bit) { return (corner & bit) != 0 ? half : -half; };
  std::vector<glm::dvec3> directions;
  for (const FaceVertex& vertex : facesAt({toward(1), toward(2), toward(4)}, gridLevel))
    directions.push_back(direction(vertex.face, gridLevel, vertex.column, vertex.row));
  return directions;
}

TEST(CubeSphere, ThreeFacesAgreeInEachCornerOnDirectionAndLatticePosition) {
  int torn = 0;
  for (int corner = 0; corner < 8; ++corner) {
    for (const int level : {0, 1, 2, 7, 18, FacePath::kMaxLevel}) {
      const int gridLevel = level + 6;  // of 64 cells
      const std::vector<glm::dvec3> directions = atCubeCorner(cubeGridDirection, corner, gridLevel);
      ASSERT_EQ(directions.size(), 3u);
      EXPECT_TRUE(sameBits(directions[0], directions[1]) && sameBits(directions[0], directions[2])) << corner;
      // The same number in all three components, or a corner would lean towards one of its faces.
      EXPECT_EQ(std::fabs(directions[0].x), std::fabs(directions[0].y));
      EXPECT_EQ(std::fabs(directions[0].x), std::fabs(directions[0].z));
      for (const double radiusMeters : {kMinRadiusMeters, 1'737'400.0, 6'371'000.0, kMaxRadiusMeters}) {
        const int exponent = stepExponent(radiusMeters, level);
        const LatticePoint first = roundToLattice(directions[0] * radiusMeters, exponent);
        EXPECT_EQ(first, roundToLattice(directions[1] * radiusMeters, exponent));
        EXPECT_EQ(first, roundToLattice(directions[2] * radiusMeters, exponent));
      }
      const std::vector<glm::dvec3> control = atCubeCorner(withLibraryTangent, corner, gridLevel);
      torn += !sameBits(control[0], control[1]) || !sameBits(control[0], control[2]);
    }
  }
  EXPECT_EQ(torn, 8 * 6) << "the control, std::tan, is torn in every corner";
}

}  // namespace
}  // namespace terrane

// Directions of the cube sphere against MPFR, the way back to face coordinates, and both at the hard places.

#include "common/tiling/cube_sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iostream>
#include <random>
#include <vector>

#include "common/tiling/face_path.h"
#include "tests/numeric/samples.h"
#include "tests/support/high_precision.h"

namespace terrane {
namespace {

using Precise = test::HighPrecision;
using test::sameBits;

TEST(CubeSphere, DirectionsHaveUnitLengthAndAgreeWithMultiprecision) {
  std::mt19937_64 random = test::seededRandom(105);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Precise quarterPi = atan(Precise(1));
  double worstLength = 0;
  Precise worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const int face = static_cast<int>(random() % 6);
    const double s = unit(random);
    const double t = unit(random);
    const glm::dvec3 d = cubeDirection(face, s, t);
    worstLength = std::max(worstLength, std::fabs(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - 1.0));
    const FaceAxes& axes = cubeFaceAxes(face);
    const Precise a = tan(Precise(quarterPi * s));
    const Precise b = tan(Precise(quarterPi * t));
    const Precise norm = sqrt(Precise(1 + a * a + b * b));
    for (int k = 0; k < 3; ++k) {
      const Precise exact = (Precise(axes.normal[k]) + axes.u[k] * a + axes.v[k] * b) / norm;
      worst = std::max(worst, Precise(abs(Precise(exact - d[k]))));
    }
  }
  std::cout << "worst component error " << static_cast<double>(worst) << ", length " << worstLength << '\n';
  EXPECT_LE(worst, Precise(kCubeDirectionError));
  EXPECT_LE(worstLength, 5e-16);
}

constexpr std::uint64_t kCells = std::uint64_t{1} << FacePath::kMaxLevel;

/// Components within kCubeDirectionError of a vector whose largest is at least 1/sqrt(3) give ratios within 2 sqrt(3)
/// times that; the arc tangent's slope is at most 4/pi, and it adds its own error. A cell of level 30 is 1.9e-9 wide.
constexpr double kRoundTripError = 2 * 1.7321 * 1.2733 * kCubeDirectionError + kAtanQuarterPiError + 0x1p-53;

struct Cell {
  int face;
  std::uint64_t column, row;
  bool operator==(const Cell&) const = default;
};

/// Cells of level 30 at the corners, edges and centre lines (the poles, the meridians of 0, 90, 180 degrees) of every
/// face, one or two cells off them too, and anywhere.
std::vector<Cell> hardAndRandomCells() {
  std::vector<Cell> cells;
  const std::array<std::uint64_t, 9> hard{0,          1,          2,          kCells / 2 - 2, kCells / 2 - 1,
                                          kCells / 2, kCells - 3, kCells - 2, kCells - 1};
  std::mt19937_64 random = test::seededRandom(106);
  for (int face = 0; face < 6; ++face) {
    for (const std::uint64_t column : hard) {
      for (const std::uint64_t row : hard) cells.push_back({face, column, row});
      cells.push_back({face, column, random() % kCells});
      cells.push_back({face, random() % kCells, column});
    }
    for (int i = 0; i < 3000; ++i) cells.push_back({face, random() % kCells, random() % kCells});
  }
  return cells;
}

glm::dvec3 centreOf(const Cell& cell) {
  return cubeGridDirection(cell.face, FacePath::kMaxLevel + 1, 2 * cell.column + 1, 2 * cell.row + 1);
}

Cell cellAt(const FaceCoordinates& at) {
  const auto index = [](double s) { return static_cast<std::uint64_t>((s + 1.0) * 0.5 * static_cast<double>(kCells)); };
  return {at.face, index(at.s), index(at.t)};
}

TEST(CubeSphere, TheCentreOfACellOfLevelThirtyFallsBackIntoThatCell) {
  std::mt19937_64 random = test::seededRandom(107);
  const std::vector<Cell> cells = hardAndRandomCells();
  double worst = 0;
  std::size_t lostInFloat = 0;
  for (const Cell& cell : cells) {
    const glm::dvec3 centre = centreOf(cell);
    const double length = std::ldexp(1.0, static_cast<int>(random() % 2000) - 1000);
    const FaceCoordinates at = cubeFaceCoordinates(centre * length);
    ASSERT_EQ(cellAt(at), cell) << "face " << cell.face << ", " << cell.column << ' ' << cell.row;
    const auto error = [](double got, std::uint64_t line) {
      return std::fabs(got - (std::ldexp(static_cast<double>(2 * line + 1), -FacePath::kMaxLevel) - 1.0));
    };
    worst = std::max({worst, error(at.s, cell.column), error(at.t, cell.row)});
    // The control: the direction kept in float.
    lostInFloat += !(cellAt(cubeFaceCoordinates(glm::dvec3(glm::vec3(centre)))) == cell);
  }
  std::cout << cells.size() << " cells: worst error " << worst << ", bound " << kRoundTripError << ", half a cell "
            << std::ldexp(1.0, -FacePath::kMaxLevel) << "; control, float: " << lostInFloat << " in another cell\n";
  EXPECT_LE(worst, kRoundTripError);
  EXPECT_LT(kRoundTripError, std::ldexp(1.0, -FacePath::kMaxLevel));
  EXPECT_GT(lostInFloat, cells.size() * 9 / 10);
}
TEST(CubeSphere, EveryBuildComputesTheSameBits) {
  // Golden: any compiler, optimisation level and CPU must come to this hash, for tiles are made of these bits.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&](double value) { hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u; };
  std::uint64_t state = 1;
  const auto next = [&] { return state = state * 6364136223846793005u + 1442695040888963407u; };
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t column = next() >> 28;
    const std::uint64_t row = next() >> 28;
    const glm::dvec3 d = cubeGridDirection(i % 6, 36, column, row);
    const FaceCoordinates at = cubeFaceCoordinates(d);
    for (const double value : {d.x, d.y, d.z, at.s, at.t}) mix(value);
  }
  EXPECT_EQ(hash, 15173886735410959900u);
}

TEST(CubeSphere, PolesAxesCornersAndTiesHaveOneFiniteAnswer) {
  for (int face = 0; face < 6; ++face) {
    const FaceAxes& axes = cubeFaceAxes(face);
    EXPECT_TRUE(sameBits(cubeDirection(face, 0, 0), axes.normal + glm::dvec3(0.0)));
    const FaceCoordinates center = cubeFaceCoordinates(axes.normal * 1e-310);
    EXPECT_EQ(center.face, face);
    EXPECT_EQ(center.s, 0.0);
    EXPECT_EQ(center.t, 0.0);
  }
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    const FaceCoordinates at = cubeFaceCoordinates(p * 123.0);
    EXPECT_EQ(at.face, (corner & 1) ? 0 : 1) << "ties go to the lowest face";
    EXPECT_EQ(std::fabs(at.s), 1.0);
    EXPECT_EQ(std::fabs(at.t), 1.0);
    const glm::dvec3 back = cubeDirection(at.face, at.s, at.t);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(back[k] * std::sqrt(3.0), p[k], 1e-15);
  }
  EXPECT_EQ(cubeFaceCoordinates(glm::dvec3(0, -2, 2)).face, 3);
  EXPECT_EQ(cubeFaceCoordinates(glm::dvec3(-0.0, 0.0, -1e300)).face, 5);
}

}  // namespace
}  // namespace terrane

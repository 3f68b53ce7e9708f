// Directions of the icosahedral sphere against MPFR by both maps, to the finest grid and at the hard places, and the
// way back from a direction to its tile.

#include "common/tiling/ico_sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "tests/numeric/samples.h"
#include "tests/support/ico_precise.h"

namespace terrane {
namespace {

using test::HighPrecision;
using test::PreciseVector;
using test::sameBits;

class IcoSphere : public testing::TestWithParam<IcoMap> {};
INSTANTIATE_TEST_SUITE_P(Maps, IcoSphere, testing::Values(IcoMap::Bisected, IcoMap::Gnomonic),
                         [](const auto& map) { return map.param == IcoMap::Bisected ? "Bisected" : "Gnomonic"; });

struct FacePoint {
  int face, gridLevel;
  FaceWeights weights;
};

/// At, beside and around corners, the middles and ends of edges (the poles among the middles, the antimeridian along
/// one edge) and the centre of every face; in its interior at random.
std::vector<FacePoint> hardAndRandomPoints(std::uint64_t seed) {
  std::mt19937_64 random = test::seededRandom(seed);
  std::vector<FacePoint> points;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (const int gridLevel : {0, 1, 2, 3, 6, 13, 20, 29, 36}) {
      const std::int64_t whole = std::int64_t{1} << gridLevel;
      const std::int64_t somewhere = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(whole + 1));
      for (const std::int64_t a :
           {std::int64_t{0}, std::int64_t{1}, whole / 3, whole / 2, whole - 1, whole, somewhere}) {
        for (const std::int64_t b : {std::int64_t{0}, std::int64_t{1}, (whole - a) / 2, whole - a - 1, whole - a}) {
          if (b < 0 || a + b > whole) continue;
          points.push_back({face, gridLevel, FaceWeights(a, b, whole - a - b)});
          points.push_back({face, gridLevel, FaceWeights(whole - a - b, a, b)});
        }
      }
      for (int i = 0; i < 10; ++i) {
        const auto a = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(whole + 1));
        const auto b = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(whole - a + 1));
        points.push_back({face, gridLevel, FaceWeights(a, b, whole - a - b)});
      }
    }
  }
  return points;
}

double errorOf(const glm::dvec3& got, const PreciseVector& exact) {
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const HighPrecision error = exact[static_cast<std::size_t>(axis)] - HighPrecision(got[axis]);
    worst = std::max(worst, std::fabs(static_cast<double>(error)));
  }
  return worst;
}

TEST_P(IcoSphere, DirectionsAgreeWithMultiprecisionToTheFinestGrid) {
  double worst = 0, worstShare = 0, worstInFloat = 0;
  const std::vector<FacePoint> points = hardAndRandomPoints(701);
  for (const FacePoint& p : points) {
    const PreciseVector exact = test::preciseDirection(GetParam(), p.face, p.gridLevel, p.weights);
    const double error = errorOf(icoGridDirection(GetParam(), p.face, p.gridLevel, p.weights), exact);
    worst = std::max(worst, error);
    worstShare = std::max(worstShare, error / icoDirectionError(GetParam(), p.gridLevel));
    ASSERT_LE(error, icoDirectionError(GetParam(), p.gridLevel)) << p.face << " at grid level " << p.gridLevel;
    // The control: weights kept in float.
    const FaceWeights rounded(std::llround(static_cast<float>(p.weights.x)),
                              std::llround(static_cast<float>(p.weights.y)),
                              std::llround(static_cast<float>(p.weights.z)));
    worstInFloat = std::max(worstInFloat, errorOf(icoGridDirection(IcoMap::Gnomonic, p.face, p.gridLevel, rounded),
                                                  test::preciseGnomonic(p.face, p.weights)));
  }
  std::cout << points.size() << " points: worst component error " << worst << ", at most " << worstShare
            << " of the bound, which is " << icoDirectionError(GetParam(), 36)
            << " at the finest grid; control, weights in float: " << worstInFloat << '\n';
  EXPECT_GT(worstInFloat, 1000 * icoDirectionError(GetParam(), 36));
}

TEST_P(IcoSphere, ATilesGridIsWhatItsVerticesAreOneByOne) {
  std::mt19937_64 random = test::seededRandom(702);
  const int cells = 64;
  std::vector<double> x(static_cast<std::size_t>(triangleGridSize(cells))), y = x, z = x;
  double worst = 0;
  for (int round = 0; round < 31; ++round) {
    const FacePath path = test::randomIcoTile(random, round);
    icoGridDirections(GetParam(), path, cells, {x, y, z});
    const TriangleTile tile = triangleTile(path);
    test::PreciseBisection bisection(path.face());
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i + j <= cells; ++i) {
        const FaceWeights weights = gridVertexWeights(tile, cells, {i, j});
        const auto at = static_cast<std::size_t>(triangleGridIndex(cells, {i, j}));
        const glm::dvec3 got(x[at], y[at], z[at]);
        ASSERT_TRUE(sameBits(got, icoGridDirection(GetParam(), path.face(), path.level() + 6, weights)))
            << path.text() << ' ' << i << ' ' << j;
        if (i % 5 != 0 || round % 3 != 0) continue;
        const PreciseVector exact = GetParam() == IcoMap::Gnomonic ? test::preciseGnomonic(path.face(), weights)
                                                                   : bisection.at(path.level() + 6, weights);
        worst = std::max(worst, errorOf(got, exact) / icoDirectionError(GetParam(), path.level() + 6));
      }
    }
    const auto corners = icoCornerDirections(GetParam(), path);
    EXPECT_TRUE(sameBits(corners[0], glm::dvec3(x[0], y[0], z[0])));
    EXPECT_TRUE(sameBits(corners[1], glm::dvec3(x[64], y[64], z[64])));
    EXPECT_TRUE(sameBits(corners[2], glm::dvec3(x.back(), y.back(), z.back())));
    std::vector<double> ex(static_cast<std::size_t>(cells) + 1), ey = ex, ez = ex;
    for (int edge = 0; edge < 3; ++edge) {
      icoEdgeDirections(GetParam(), path, edge, cells, {ex, ey, ez});
      for (std::size_t k = 0; k < ex.size(); ++k) {
        const auto at =
            static_cast<std::size_t>(triangleGridIndex(cells, edgeVertex(cells, edge, static_cast<int>(k))));
        ASSERT_TRUE(sameBits(glm::dvec3(ex[k], ey[k], ez[k]), glm::dvec3(x[at], y[at], z[at])))
            << path.text() << " edge " << edge << " vertex " << k;
      }
    }
  }
  std::cout << "worst error " << worst << " of the bound\n";
  EXPECT_LE(worst, 1.0);
}

TEST_P(IcoSphere, AChildsEvenVerticesAreItsParentsAndByBisectionItsOddOnesLieExactlyBetweenThem) {
  std::mt19937_64 random = test::seededRandom(703);
  const int cells = 64;
  const auto size = static_cast<std::size_t>(triangleGridSize(cells));
  std::vector<double> x(size), y(size), z(size), cx(size), cy(size), cz(size);
  for (int round = 0; round < 30; ++round) {
    const FacePath parent = test::randomIcoTile(random, round);
    icoGridDirections(GetParam(), parent, cells, {x, y, z});
    const auto ofParent = [&](const GridVertex& v) {
      const auto at = static_cast<std::size_t>(triangleGridIndex(cells, v));
      return glm::dvec3(x[at], y[at], z[at]);
    };
    for (int digit = 0; digit < 4; ++digit) {
      icoGridDirections(GetParam(), parent.child(digit), cells, {cx, cy, cz});
      for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i + j <= cells; ++i) {
          const auto at = static_cast<std::size_t>(triangleGridIndex(cells, {i, j}));
          const glm::dvec3 own(cx[at], cy[at], cz[at]);
          const auto [first, second] = parentGridVertices(digit, cells, {i, j});
          if (first == second) {
            ASSERT_TRUE(sameBits(own, ofParent(first))) << parent.text() << ' ' << digit;
          } else if (GetParam() == IcoMap::Bisected) {
            const glm::dvec3 sum = ofParent(first) + ofParent(second);
            const double length = std::sqrt((sum.x * sum.x + sum.y * sum.y) + sum.z * sum.z);
            ASSERT_TRUE(sameBits(own, glm::dvec3(sum.x / length, sum.y / length, sum.z / length)));
          }
        }
      }
    }
  }
}

TEST_P(IcoSphere, PolesAxesAndVerticesAreExactAndLieOnTheirMeridians) {
  const auto at = [&](int face, const FaceWeights& weights) { return icoGridDirection(GetParam(), face, 1, weights); };
  // Faces 8 .. 19 have the edge at an axis opposite corner 0.
  for (int face = 8; face < 20; ++face) {
    glm::dvec3 axis(0.0);
    axis[(face - 8) / 4] = (face & 2) != 0 ? -1 : 1;
    EXPECT_TRUE(sameBits(at(face, FaceWeights(0, 1, 1)), axis)) << face;
  }
  for (int face = 0; face < 20; ++face) {
    for (int k = 0; k < 3; ++k) {
      FaceWeights weights(0);
      weights[k] = std::int64_t{1} << 36;
      const glm::dvec3 vertex = icosahedronVertex(icosahedronCorners(face)[static_cast<std::size_t>(k)]);
      EXPECT_TRUE(sameBits(icoGridDirection(GetParam(), face, 36, weights), vertex));
    }
  }
  // The edge of face 10 opposite corner 0 lies along the antimeridian: y is 0 all along, never -0.
  for (std::int64_t b = 0; b <= 64; ++b) {
    const glm::dvec3 d = icoGridDirection(GetParam(), 10, 6, FaceWeights(0, b, 64 - b));
    EXPECT_TRUE(sameBits(d.y, 0.0) && d.x < -0.8) << b;
  }
}

TEST_P(IcoSphere, EveryBuildComputesTheSameBits) {
  // Golden: any compiler, optimisation level and CPU must come to this hash, for tiles are made of these bits.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto mix = [&](std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3u; };
  std::uint64_t state = 1;
  const auto next = [&] { return state = state * 6364136223846793005u + 1442695040888963407u; };
  for (int i = 0; i < 20000; ++i) {
    const auto a = static_cast<std::int64_t>(next() >> 29), b = static_cast<std::int64_t>(next() >> 29);
    const std::int64_t whole = std::int64_t{1} << 36;
    const glm::dvec3 d = icoGridDirection(GetParam(), i % 20, 36, FaceWeights(a, b, whole - a - b));
    for (const double value : {d.x, d.y, d.z}) mix(std::bit_cast<std::uint64_t>(value));
    mix(icoTileAt(GetParam(), d, 30).packedDigits());
  }
  EXPECT_EQ(hash, GetParam() == IcoMap::Bisected ? 10502183879867841022u : 7899761192679529033u);
}

}  // namespace
}  // namespace terrane

#include "common/tiling/cube_sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

#include "common/tiling/quarter_pi_polynomials.h"

namespace terrane {
namespace {

using Precise = boost::multiprecision::cpp_bin_float_50;

const Precise& quarterPi() {
  static const Precise value = atan(Precise(1));
  return value;
}

bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool sameBits(const glm::dvec3& a, const glm::dvec3& b) {
  return sameBits(a.x, b.x) && sameBits(a.y, b.y) && sameBits(a.z, b.z);
}

/// Arguments in [0, 1]: uniform, small ones down to 2^-60, and close to both ends and to where the reduction begins.
std::vector<double> arguments(std::uint64_t seed, int count, double fold) {
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<double> out;
  for (int i = 0; i < count; ++i) {
    const double x = unit(random);
    out.push_back(x);
    out.push_back(x * std::ldexp(1.0, -static_cast<int>(random() % 60)));
    out.push_back(1.0 - x * std::ldexp(1.0, -static_cast<int>(random() % 50)));
    out.push_back(std::clamp(fold + (x - 0.5) * 0.02, 0.0, 1.0));
  }
  return out;
}

TEST(QuarterPi, PolynomialsAreMinimaxToTheStatedError) {
  const auto evaluate = [](const auto& coefficients, double high, double low, const Precise& x) {
    Precise sum = 0;
    for (std::size_t i = coefficients.size(); i-- > 0;) sum = sum * x * x + Precise(coefficients[i]);
    return Precise(x * (Precise(high) + Precise(low) + x * x * sum));
  };
  Precise worstTangent = 0;
  Precise worstArcTangent = 0;
  for (int i = 1; i <= 500; ++i) {
    const Precise x = Precise(i) * quarter_pi::kTangentRange / 500;
    const Precise tangent = tan(Precise(x * quarterPi()));
    worstTangent = std::max(
        worstTangent,
        Precise(abs(Precise(
            evaluate(quarter_pi::kTangent, quarter_pi::kTangentHigh, quarter_pi::kTangentLow, x) / tangent - 1))));
    const Precise z = Precise(i) * quarter_pi::kArcTangentRange / 500;
    const Precise angle = atan(z) / quarterPi();
    worstArcTangent = std::max(
        worstArcTangent,
        Precise(abs(Precise(
            evaluate(quarter_pi::kArcTangent, quarter_pi::kArcTangentHigh, quarter_pi::kArcTangentLow, z) / angle -
            1))));
  }
  std::cout << "polynomial error: tan " << static_cast<double>(log2(worstTangent)) << " bits, atan "
            << static_cast<double>(log2(worstArcTangent)) << " bits\n";
  EXPECT_LE(worstTangent, Precise(quarter_pi::kPolynomialError));
  EXPECT_LE(worstArcTangent, Precise(quarter_pi::kPolynomialError));
}

TEST(QuarterPi, TangentIsWithinItsBound) {
  Precise worst = 0;
  double where = 0;
  for (const double x : arguments(101, 1500, quarter_pi::kTangentRange)) {
    if (x == 0) continue;
    const Precise exact = tan(Precise(quarterPi() * x));
    const Precise error = abs(Precise(Precise(tanQuarterPi(x)) / exact - 1));
    if (error > worst) {
      worst = error;
      where = x;
    }
  }
  std::cout << "worst relative error " << static_cast<double>(worst) << " at " << where << '\n';
  EXPECT_LE(worst, Precise(kTanQuarterPiError));
}

TEST(QuarterPi, ArcTangentIsWithinItsBound) {
  Precise worst = 0;
  Precise worstRelative = 0;
  for (const double t : arguments(102, 1500, quarter_pi::kArcTangentRange)) {
    if (t == 0) continue;
    const Precise exact = atan(Precise(t)) / quarterPi();
    const Precise error = abs(Precise(Precise(atanQuarterPi(t)) - exact));
    worst = std::max(worst, error);
    worstRelative = std::max(worstRelative, Precise(error / exact));
  }
  std::cout << "worst error " << static_cast<double>(worst) << ", relative " << static_cast<double>(worstRelative)
            << '\n';
  EXPECT_LE(worst, Precise(kAtanQuarterPiError));
  EXPECT_LE(worstRelative, Precise(kAtanQuarterPiRelativeError));
}

TEST(QuarterPi, EndsAndZeroAreExactAndNothingElseIsStrange) {
  using Limits = std::numeric_limits<double>;
  for (const auto function : {&tanQuarterPi, &atanQuarterPi}) {
    EXPECT_TRUE(sameBits(function(1.0), 1.0));
    EXPECT_TRUE(sameBits(function(-1.0), -1.0));
    EXPECT_TRUE(sameBits(function(0.0), 0.0));
    EXPECT_TRUE(sameBits(function(-0.0), -0.0));
    EXPECT_TRUE(std::isnan(function(Limits::quiet_NaN())));
    // Denormals: nothing finer than the spacing of denormals can be asked for.
    for (const double x : {Limits::denorm_min(), 37 * Limits::denorm_min(), Limits::min() * 0.75, Limits::min()}) {
      const double slope = function == &tanQuarterPi ? 0.78539816339744831 : 1.2732395447351628;
      EXPECT_LE(std::fabs(function(x) - slope * x), Limits::denorm_min());
      EXPECT_TRUE(sameBits(function(-x), -function(x)));
    }
  }
  // The control: what the C library makes of the same edge.
  const volatile double quarter = 0.78539816339744831;
  std::cout << "std::tan(pi/4) = 1 - " << 1.0 - std::tan(quarter) << '\n';
  EXPECT_NE(std::tan(quarter), 1.0);
}

TEST(QuarterPi, BothAreOddMonotoneAndInverse) {
  std::vector<double> xs = arguments(103, 5000, quarter_pi::kTangentRange);
  std::sort(xs.begin(), xs.end());
  double last = -1;
  double worst = 0;
  for (const double x : xs) {
    const double t = tanQuarterPi(x);
    ASSERT_TRUE(sameBits(tanQuarterPi(-x), -t));
    ASSERT_TRUE(sameBits(atanQuarterPi(-t), -atanQuarterPi(t)));
    ASSERT_LE(t, 1.0);
    ASSERT_GE(t, last - 4e-16);
    last = t;
    worst = std::max(worst, std::fabs(atanQuarterPi(t) - x));
  }
  std::cout << "worst round trip " << worst << '\n';
  EXPECT_LE(worst, 1e-15);
}

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

TEST(CubeSphere, FacesThatShareAVertexComputeTheSameBits) {
  const SharedCount coarse = compareSharedVertices(cubeGridDirection, 8, allPositions(8));
  EXPECT_EQ(coarse.differing, 0) << "of " << coarse.vertices;
  EXPECT_EQ(coarse.cubeCorners, 6 * 8) << "8 corners, seen from 3 faces, each along two edges";

  const std::uint64_t seed = 104;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (const int gridLevel : {0, 1, 17, 36, 52}) {
    const std::uint64_t last = std::uint64_t{1} << gridLevel;
    std::vector<std::uint64_t> positions{0, last / 2, last};
    for (int i = 0; i < 500; ++i) positions.push_back(random() % (last + 1));
    EXPECT_EQ(compareSharedVertices(cubeGridDirection, gridLevel, positions).differing, 0) << gridLevel;
  }
}

// The two ways that are usual elsewhere, as controls: both must fail where ours does not.
glm::dvec3 directionWith(int face, double a, double b, bool worldOrder) {
  const FaceAxes& axes = cubeFaceAxes(face);
  const glm::dvec3 p = axes.normal + axes.u * a + axes.v * b;
  const double norm = worldOrder ? std::sqrt((p.x * p.x + p.y * p.y) + p.z * p.z) : std::sqrt((1.0 + a * a) + b * b);
  return glm::dvec3(p.x / norm, p.y / norm, p.z / norm);
}

TEST(CubeSphere, TheLibrarysTangentWouldTearTheFaceEdges) {
  const auto control = [](int face, int gridLevel, std::uint64_t column, std::uint64_t row) {
    const double scale = std::ldexp(2.0, -gridLevel);
    const double quarter = 0.78539816339744831;
    return directionWith(face, std::tan((static_cast<double>(column) * scale - 1.0) * quarter),
                         std::tan((static_cast<double>(row) * scale - 1.0) * quarter), true);
  };
  const SharedCount count = compareSharedVertices(control, 8, allPositions(8));
  std::cout << "std::tan without exact ends: " << count.differing << " of " << count.vertices
            << " shared vertices differ\n";
  EXPECT_GT(count.differing, 0);
}

TEST(CubeSphere, NormalisingInFaceOrderWouldTearTheFaceEdges) {
  const auto control = [](int face, int gridLevel, std::uint64_t column, std::uint64_t row) {
    const double scale = std::ldexp(2.0, -gridLevel);
    return directionWith(face, tanQuarterPi(static_cast<double>(column) * scale - 1.0),
                         tanQuarterPi(static_cast<double>(row) * scale - 1.0), false);
  };
  const SharedCount count = compareSharedVertices(control, 8, allPositions(8));
  std::cout << "norm in face order: " << count.differing << " of " << count.vertices << " shared vertices differ\n";
  EXPECT_GT(count.differing, 0);
}

TEST(CubeSphere, DirectionsHaveUnitLengthAndAgreeWithMultiprecision) {
  const std::uint64_t seed = 105;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worstLength = 0;
  Precise worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const int face = static_cast<int>(random() % 6);
    const double s = unit(random);
    const double t = unit(random);
    const glm::dvec3 d = cubeDirection(face, s, t);
    worstLength = std::max(worstLength, std::fabs(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) - 1.0));
    const FaceAxes& axes = cubeFaceAxes(face);
    const Precise a = tan(Precise(quarterPi() * s));
    const Precise b = tan(Precise(quarterPi() * t));
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

TEST(CubeSphere, ACellsCentreAtLevelThirtyFallsBackIntoItsCell) {
  const std::uint64_t seed = 106;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  const std::uint64_t cells = std::uint64_t{1} << 30;
  for (int i = 0; i < 20000; ++i) {
    const int face = static_cast<int>(random() % 6);
    const auto index = [&] {
      const std::uint64_t x = random() % cells;
      const std::uint64_t kind = random() % 8;
      return kind == 0 ? 0 : kind == 1 ? cells - 1 : kind == 2 ? cells / 2 : x;
    };
    const std::uint64_t column = index();
    const std::uint64_t row = index();
    const double length = std::ldexp(1.0, static_cast<int>(random() % 2000) - 1000);
    const glm::dvec3 d = cubeGridDirection(face, 31, 2 * column + 1, 2 * row + 1);
    const FaceCoordinates at = cubeFaceCoordinates(d * length);
    ASSERT_EQ(at.face, face);
    ASSERT_EQ(static_cast<std::uint64_t>((at.s + 1.0) * 0.5 * static_cast<double>(cells)), column);
    ASSERT_EQ(static_cast<std::uint64_t>((at.t + 1.0) * 0.5 * static_cast<double>(cells)), row);
  }
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

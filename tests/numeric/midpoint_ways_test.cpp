// Two ways to do midpoint displacement on a sphere that are not taken here, beside the ones that are.
//
// Middles by averaging longitudes and colatitudes: wrong by half a world where an edge crosses the antimeridian, by the
// colatitude where it passes over a pole, and a little everywhere else; the normalised middle of the two directions
// knows no such places.
//
// Noise as the fraction of a sine times a large number: it takes the vertex' position as a number to be rounded, so it
// is smooth from vertex to vertex where cells are small, has few values where the factor reaches what a double
// resolves, and is another with each way to round: with float or double, with fused multiply-add or without. A hash of
// the vertex' own integers is none of that.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>
#include <vector>

#include "common/tiling/ico_sphere.h"
#include "server/fields/midpoint_keys.h"
#include "tests/numeric/samples.h"
#include "tests/support/moon_body.h"

namespace terrane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Middles.

glm::dvec3 fromAngles(double colatitude, double longitude) {
  return {std::sin(colatitude) * std::cos(longitude), std::sin(colatitude) * std::sin(longitude), std::cos(colatitude)};
}
glm::dvec3 middleByAngles(const glm::dvec3& a, const glm::dvec3& b) {
  const auto colatitude = [](const glm::dvec3& d) { return std::atan2(std::hypot(d.x, d.y), d.z); };
  const auto longitude = [](const glm::dvec3& d) { return std::atan2(d.y, d.x); };
  return fromAngles((colatitude(a) + colatitude(b)) / 2, (longitude(a) + longitude(b)) / 2);
}

struct Edge {
  glm::dvec3 a, b, middle;
};

/// All edges of the grids of some levels, and where their middles are as tiles have them.
std::vector<Edge> edgesOfLevel(int level) {
  std::vector<Edge> edges;
  const std::int64_t whole = std::int64_t{1} << level;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    const auto at = [&](std::int64_t i, std::int64_t j, std::int64_t parts) {
      return icoGridDirection(kIcoMap, face, parts == whole ? level : level + 1, {parts - i - j, i, j});
    };
    for (std::int64_t j = 0; j < whole; ++j) {
      for (std::int64_t i = 0; i + j < whole; ++i) {
        const auto add = [&](std::int64_t i0, std::int64_t j0, std::int64_t i1, std::int64_t j1) {
          edges.push_back({at(i0, j0, whole), at(i1, j1, whole), at(i0 + i1, j0 + j1, 2 * whole)});
        };
        add(i, j, i + 1, j);
        add(i, j, i, j + 1);
        add(i + 1, j, i, j + 1);
      }
    }
  }
  return edges;
}

bool crossesAntimeridian(const Edge& edge) { return (edge.a.y < 0) != (edge.b.y < 0) && edge.a.x + edge.b.x < 0; }

TEST(MiddlesByAngles, AreHalfAWorldOffAtTheAntimeridianAndWrongAtThePoles) {
  for (const int level : {0, 3, 6}) {
    double atWrap = 0, atPole = 0, elsewhere = 0, own = 0, spacing = 0;
    int crossing = 0;
    for (const Edge& edge : edgesOfLevel(level)) {
      const double off = angleBetween(middleByAngles(edge.a, edge.b), edge.middle);
      const double length = angleBetween(edge.a, edge.b);
      spacing = std::max(spacing, length);
      // Equally far from both ends, and in one plane with them.
      own = std::max(own, std::abs(angleBetween(edge.a, edge.middle) - angleBetween(edge.middle, edge.b)));
      own = std::max(own, std::abs(glm::dot(glm::cross(edge.a, edge.b) / std::sin(length), edge.middle)));
      if (std::hypot(edge.middle.x, edge.middle.y) < length) {
        atPole = std::max(atPole, off);
      } else if (crossesAntimeridian(edge)) {
        ++crossing;
        atWrap = std::max(atWrap, off);
      } else {
        elsewhere = std::max(elsewhere, off);
      }
    }
    std::printf(
        "level %d, edges of %.3g degrees: by angles off by %.4g degrees (%.0f km on the Moon) at %d edges over the "
        "antimeridian, %.3g degrees (%.0f km) within an edge of a pole, %.2g degrees (%.0f m) elsewhere; directions: "
        "%.1g degrees (%.1g m)\n",
        level, spacing / kDegree, atWrap / kDegree, atWrap * kMoonRadiusMeters / 1e3, crossing, atPole / kDegree,
        atPole * kMoonRadiusMeters / 1e3, elsewhere / kDegree, elsewhere * kMoonRadiusMeters, own / kDegree,
        own * kMoonRadiusMeters);
    if (level > 0) {
      EXPECT_GT(crossing, 0);
      EXPECT_GT(atWrap, 170 * kDegree);
      EXPECT_GT(elsewhere, 0.01 * spacing) << "averages of angles are middles along meridians and the equator alone";
    }
    EXPECT_GT(atPole, 0.4 * spacing) << "no finer grid helps: the error is as large as the cells";
    EXPECT_LT(own, 1e-14 / std::min(1.0, spacing)) << "no error that is seen";
  }
}

// Noise.

constexpr int kCells = 64;

/// The vertices of a tile, as a shader or a program sees them: directions; and as this one does.
struct TileVertices {
  std::vector<double> x, y, z;
  std::vector<VertexKey> keys;
};

TileVertices verticesOf(const FacePath& path) {
  TileVertices out;
  const auto count = static_cast<std::size_t>(triangleGridSize(kCells));
  out.x.resize(count);
  out.y.resize(count);
  out.z.resize(count);
  icoGridDirections(kIcoMap, path, kCells, {out.x, out.y, out.z});
  const TriangleTile tile = triangleTile(path);
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i + j <= kCells; ++i)
      out.keys.push_back(icoVertexKey(path.face(), gridVertexWeights(tile, kCells, {i, j})));
  return out;
}

template <class Real>
Real fraction(Real x) {
  return x - std::floor(x);
}

/// fract(sin(p . v) factor), in -1 .. 1.
template <class Real>
std::vector<double> sineNoise(const TileVertices& at, Real factor, bool fused) {
  const Real v[3] = {Real(12.9898), Real(78.233), Real(45.164)};
  std::vector<double> noise;
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    const Real x = static_cast<Real>(at.x[i]), y = static_cast<Real>(at.y[i]), z = static_cast<Real>(at.z[i]);
    const Real dot = fused ? std::fma(z, v[2], std::fma(y, v[1], x * v[0])) : (x * v[0] + y * v[1]) + z * v[2];
    noise.push_back(2 * static_cast<double>(fraction(std::sin(dot) * factor)) - 1);
  }
  return noise;
}

std::vector<double> hashNoise(const TileVertices& at, int gridLevel) {
  const MidpointDisplacement displacement(1, 0, 1);
  std::vector<double> noise;
  for (const VertexKey& key : at.keys)
    noise.push_back(displacement.meters(gridLevel, key) / displacement.largestMeters(gridLevel));
  return noise;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  double sumA = 0, sumB = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sumA += a[i], sumB += b[i];
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - sumA / n) * (b[i] - sumB / n);
    aa += (a[i] - sumA / n) * (a[i] - sumA / n);
    bb += (b[i] - sumB / n) * (b[i] - sumB / n);
  }
  return ab / std::sqrt(aa * bb);
}

/// Of vertices and the ones after them in their rows.
double correlationOfNeighbours(const std::vector<double>& noise) {
  std::vector<double> here, next;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i + 1 + j <= kCells; ++i) {
      here.push_back(noise[static_cast<std::size_t>(triangleGridIndex(kCells, {i, j}))]);
      next.push_back(noise[static_cast<std::size_t>(triangleGridIndex(kCells, {i + 1, j}))]);
    }
  return correlation(here, next);
}

std::size_t distinct(const std::vector<double>& noise) { return std::set(noise.begin(), noise.end()).size(); }

/// The share of vertices at which two ways to compute the same noise differ by more than a hundredth of its range.
double shareApart(const std::vector<double>& a, const std::vector<double>& b) {
  int apart = 0;
  for (std::size_t i = 0; i < a.size(); ++i) apart += std::abs(a[i] - b[i]) > 0.02 ? 1 : 0;
  return apart / static_cast<double>(a.size());
}

constexpr double kUsualFactor = 43758.5453;

/// A tile far from corners, down a path without pattern.
FacePath tileAtLevel(int level) {
  FacePath path = FacePath::wholeFace(Scheme::Ico, 5);
  const int digits[] = {3, 1, 0, 2, 3, 3, 2, 1, 3, 0};
  while (path.level() < level) path = path.child(digits[path.level() % 10]);
  return path;
}

TEST(NoiseBySine, IsSmoothFromVertexToVertexAtDeepLevelsAndRepeatsInFloat) {
  for (const int level : {2, 14, 20, 26}) {
    const TileVertices at = verticesOf(tileAtLevel(level));
    const std::vector<double> asDouble = sineNoise(at, kUsualFactor, false);
    const std::vector<double> asFloat = sineNoise(at, static_cast<float>(kUsualFactor), false);
    const std::vector<double> hashed = hashNoise(at, level + 6);
    std::printf(
        "grid level %d, %zu vertices: distinct values %zu by sine in float, %zu in double, %zu hashed; correlation of "
        "neighbours %.3f by sine in double, %.3f hashed\n",
        level + 6, hashed.size(), distinct(asFloat), distinct(asDouble), distinct(hashed),
        correlationOfNeighbours(asDouble), correlationOfNeighbours(hashed));
    EXPECT_EQ(distinct(hashed), hashed.size());
    EXPECT_LT(std::abs(correlationOfNeighbours(hashed)), 5 / std::sqrt(hashed.size()));
    if (level < 20) continue;
    EXPECT_LT(distinct(asFloat), hashed.size() / 20);
    EXPECT_GT(correlationOfNeighbours(asDouble), level == 26 ? 0.9 : -1.0);
  }
}

TEST(NoiseBySine, HasAHandfulOfValuesWhereTheFactorIsTheInverseOfMachineEpsilon) {
  const TileVertices at = verticesOf(tileAtLevel(4));
  const std::vector<double> noise = sineNoise(at, 0x1p52, false);
  int common = 0;  // a sine of at least a half is a multiple of 2^-53, its product of a half
  for (const double x : noise) common += x == 0 || x == -1 ? 1 : 0;
  std::printf("factor 2^52: %zu distinct values of %zu, %.0f %% of all are one of two\n", distinct(noise), noise.size(),
              100.0 * common / static_cast<double>(noise.size()));
  EXPECT_GT(common, static_cast<int>(noise.size() / 2));
  EXPECT_EQ(distinct(hashNoise(at, 10)), noise.size());
}

/// What two builds of one program may do differently, and a vertex whose last bit two faces may see differently.
TEST(NoiseBySine, IsAnotherWithEachWayToRound) {
  const TileVertices at = verticesOf(tileAtLevel(4));
  const float factor = static_cast<float>(kUsualFactor);
  const std::vector<double> asFloat = sineNoise(at, factor, false), asDouble = sineNoise(at, kUsualFactor, false);
  const double fusedFloat = shareApart(asFloat, sineNoise(at, factor, true));
  const double floatOrDouble = shareApart(asFloat, asDouble);
  const double sharp = shareApart(sineNoise(at, 0x1p52, false), sineNoise(at, 0x1p52, true));
  TileVertices fromAnotherFace = at;
  for (auto* component : {&fromAnotherFace.x, &fromAnotherFace.y, &fromAnotherFace.z})
    for (double& value : *component) value = std::nextafter(value, 2.0);
  const double oneUlp = shareApart(sineNoise(at, 0x1p52, false), sineNoise(fromAnotherFace, 0x1p52, false));
  std::printf(
      "vertices whose noise differs by more than 1 %%: %.0f %% with fused multiply-add in float, %.0f %% between float "
      "and double, at a factor of 2^52 %.0f %% with fused multiply-add in double, %.0f %% for an ulp of each "
      "coordinate\n",
      100 * fusedFloat, 100 * floatOrDouble, 100 * sharp, 100 * oneUlp);
  EXPECT_GT(fusedFloat, 0.2);
  EXPECT_GT(floatOrDouble, 0.8);
  EXPECT_GT(sharp, 0.1);
  EXPECT_GT(oneUlp, 0.1);
  EXPECT_EQ(hashNoise(fromAnotherFace, 10), hashNoise(at, 10)) << "no position enters";
}

}  // namespace
}  // namespace terrane

#include "client/tiles/ground_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/tile_at.h"
#include "tests/support/both_schemes.h"
#include "tests/unit/client/small_tiles.h"

namespace terrane {
namespace {

using testing::smallTile;
using testing::SmallTileOptions;

double hilly(const glm::dvec3& d) { return 800.0 * d.x * d.y + 500.0 * d.z * d.z * d.x - 300.0 * d.y; }

struct Place {
  glm::dvec3 direction;
  double u, v;
};

/// Of an ico tile (u, v) are weights at corners 1 and 2, folded into the triangle.
Place placeIn(const FacePath& path, double u, double v) {
  if (path.scheme() == Scheme::Ico) {
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto corners = icoCornerDirections(kIcoMap, path);
    return {glm::normalize(corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0])), u, v};
  }
  const double tiles = std::ldexp(1.0, path.level());
  return {cubeDirection(path.face(), 2 * (path.column() + u) / tiles - 1, 2 * (path.row() + v) / tiles - 1), u, v};
}

/// Every triangle of the mesh, in long double: the tests' own, slow answer.
std::optional<double> bruteForceHeight(const Tile& tile, const glm::dvec3& direction, double radius) {
  using Vector = glm::tvec3<long double>;
  const Vector d = glm::normalize(Vector(direction));
  const auto position = [&](std::uint32_t vertex) {
    const auto step = static_cast<long double>(stepMeters(tile.metadata.stepExponent));
    Vector p;
    for (int k = 0; k < 3; ++k) {
      p[k] = step * static_cast<long double>(tile.metadata.origin[k] +
                                             tile.mesh.offsets[3 * vertex + static_cast<std::size_t>(k)]);
    }
    return p;
  };
  for (std::size_t t = 0; t < tile.mesh.triangles.size(); t += 3) {
    const Vector a = position(tile.mesh.triangles[t]), b = position(tile.mesh.triangles[t + 1]),
                 c = position(tile.mesh.triangles[t + 2]);
    const Vector normal = glm::cross(b - a, c - a);
    const long double along = glm::dot(normal, a) / glm::dot(normal, d);
    const Vector p = d * along;
    const long double edge = -1e-7L * glm::dot(normal, normal);
    if (glm::dot(glm::cross(b - a, p - a), normal) >= edge && glm::dot(glm::cross(c - b, p - b), normal) >= edge &&
        glm::dot(glm::cross(a - c, p - c), normal) >= edge) {
      return static_cast<double>(along - static_cast<long double>(radius));
    }
  }
  return std::nullopt;
}

class GroundMeshOfSchemes : public ::testing::TestWithParam<Scheme> {};

TEST_P(GroundMeshOfSchemes, AgreesWithEveryTriangleTriedInHigherPrecision) {
  constexpr unsigned kSeed = 20240711;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int compared = 0;
  for (const double radius : {250.0, testing::kMoonRadius, 7.0e8}) {
    for (int level = 0; level <= maxLevel(radius, GetParam()); level += level < 3 ? 1 : 4) {
      for (const bool alternate : {false, true}) {
        FacePath path = FacePath::wholeFace(GetParam(), static_cast<int>(faceCount(GetParam()) * unit(random)));
        while (path.level() < level) path = path.child(static_cast<int>(4 * unit(random)));
        const double scale = std::min(1.0, radius / 1e5);
        const Tile tile = smallTile(
            path, [scale](const glm::dvec3& d) { return scale * hilly(d); },
            SmallTileOptions{radius, 8, alternate, true});
        const GroundMesh mesh = GroundMesh::fromTile(tile);
        ASSERT_FALSE(mesh.empty());
        for (int i = 0; i < 60; ++i) {
          const Place place = placeIn(path, unit(random), unit(random));
          const auto height = mesh.heightMeters(place.direction, place.u, place.v, radius);
          const auto expected = bruteForceHeight(tile, place.direction, radius);
          ASSERT_TRUE(height) << path.text() << " at " << place.u << ", " << place.v;
          if (!expected) continue;  // outside by less than a step: the answer is the nearest triangle's plane
          ++compared;
          EXPECT_NEAR(*height, *expected, 4 * 2.3e-16 * radius) << path.text() << " radius " << radius;
        }
      }
    }
  }
  EXPECT_GT(compared, 2000);
}

TileMorph everywhere(float value) {
  TileMorph morph{.own = value};
  morph.sides.fill(value);
  return morph;
}

TEST_P(GroundMeshOfSchemes, OnItsWayToTheParentATileIsWhereItIsDrawn) {
  constexpr unsigned kSeed = 20261126;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double radius = testing::kMoonRadius;
  const SmallTileOptions options{radius, 8, false, true};
  double largestDifference = 0;
  for (const char* digits : {"2/0", "2/0312", "4/11111111", "0/2301230123"}) {
    const std::string text = std::string(schemeName(GetParam())) + "/" + digits;
    const FacePath parentPath = *FacePath::parse(text);
    const GroundMesh parent = GroundMesh::fromTile(smallTile(parentPath, hilly, options));
    for (int digit = 0; digit < 4; ++digit) {
      const GroundMesh mesh = GroundMesh::fromTile(smallTile(parentPath.child(digit), hilly, options));
      const double bound = 4 * 2.3e-16 * radius;
      for (int i = 0; i < 60; ++i) {
        const Place place = placeIn(parentPath.child(digit), 0.02 + 0.96 * unit(random), 0.02 + 0.96 * unit(random));
        const auto morphed = [&](const TileMorph& morph) {
          return mesh.morphedHeightMeters(place.direction, place.u, place.v, radius, morph, parent, digit).value();
        };
        const double own = mesh.heightMeters(place.direction, place.u, place.v, radius).value();
        const glm::dvec2 on = placeInTile(parentPath, place.direction);
        const double all = parent.heightMeters(place.direction, on.x, on.y, radius).value();
        EXPECT_NEAR(morphed(everywhere(0)), own, bound) << text << " " << digit;
        EXPECT_NEAR(morphed(everywhere(1)), all, bound) << text << " " << digit << " at " << place.u << ", " << place.v;
        largestDifference = std::max(largestDifference, std::abs(own - all));
        // Between them by its share, but for what moves sideways.
        EXPECT_NEAR(morphed(everywhere(0.25f)), own + 0.25 * (all - own), 0.05 * std::abs(all - own) + bound);
        // Only the edge towards u = 0 is the parent's: beyond the first column of cells (where the map of a coarse
        // triangle is not that of a plane, the second) nothing has moved.
        TileMorph edge;
        edge.sides[GetParam() == Scheme::Cube ? static_cast<std::size_t>(Side::UMin) : 1] = 1;
        if (place.u > (GetParam() == Scheme::Cube ? 0.125 : 0.2)) {
          EXPECT_NEAR(morphed(edge), own, bound);
        }
      }
    }
  }
  EXPECT_GT(largestDifference, 1000) << "or nothing was tested";
}

/// The surface of a tile drawn beside coarser ones: every triangle, in long double.
std::optional<double> drawnHeight(const Tile& tile, const Tile& parent, const TileMorph& morph,
                                  const glm::dvec3& direction, double radius) {
  using Vector = glm::tvec3<long double>;
  const TileGrid grid{tile.metadata.path.scheme(), tile.metadata.cellsPerEdge};
  const auto positions = [&](const Tile& of) {
    std::vector<Vector> byIndex(static_cast<std::size_t>(grid.vertexCount()));
    const auto step = static_cast<long double>(stepMeters(of.metadata.stepExponent));
    for (std::size_t vertex = 0; vertex < of.mesh.vertexCount(); ++vertex) {
      if (of.mesh.gridIndices[vertex] >= byIndex.size()) continue;
      for (int k = 0; k < 3; ++k)
        byIndex[of.mesh.gridIndices[vertex]][k] =
            step *
            static_cast<long double>(of.metadata.origin[k] + of.mesh.offsets[3 * vertex + static_cast<std::size_t>(k)]);
    }
    return byIndex;
  };
  const std::vector<Vector> own = positions(tile), above = positions(parent);
  const MorphByBorders byBorders = morphByBorders(grid, morph);
  const auto drawn = [&](const GridVertex& corner) {
    const GridVertex at = grid.stitched(morph.coarserEdges, corner);
    const auto [first, second] = grid.parentVertices(tile.metadata.path.digit(tile.metadata.path.level() - 1), at);
    const auto indexOf = [&](const GridVertex& v) { return static_cast<std::size_t>(grid.index(v)); };
    const Vector to = (above[indexOf(first)] + above[indexOf(second)]) / 2.0L;
    return own[indexOf(at)] + static_cast<long double>(byBorders[grid.borders(at)]) * (to - own[indexOf(at)]);
  };
  std::optional<double> found;
  const Vector d = glm::normalize(Vector(direction));
  const auto look = [&](const GridVertex& first, const GridVertex& second, const GridVertex& third) {
    const Vector a = drawn(first), b = drawn(second), c = drawn(third), normal = glm::cross(b - a, c - a);
    if (!(glm::dot(normal, d) > 0)) return;
    const long double along = glm::dot(normal, a) / glm::dot(normal, d);
    const Vector p = d * along;
    if (glm::dot(glm::cross(b - a, p - a), normal) >= 0 && glm::dot(glm::cross(c - b, p - b), normal) >= 0 &&
        glm::dot(glm::cross(a - c, p - c), normal) >= 0)
      found = static_cast<double>(along - static_cast<long double>(radius));
  };
  for (int j = 0; j < grid.cells; ++j)
    for (int i = 0; i < grid.rowEnd(j); ++i) grid.eachTriangle(i, j, look);
  return found;
}

// A camera over coarse ground is held above what is drawn: half a metre below it, it would look through the ground.
TEST_P(GroundMeshOfSchemes, BesideACoarserTileItIsTheStitchedSurfaceThatIsDrawn) {
  constexpr unsigned kSeed = 20261127;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double radius = testing::kMoonRadius;
  const SmallTileOptions options{radius, 8, false, true};
  const FacePath parentPath = *FacePath::parse(std::string(schemeName(GetParam())) + "/2/0312");
  const Tile parent = smallTile(parentPath, hilly, options);
  const int edges = edgeCount(GetParam());
  int compared = 0;
  double unstitchedDiffers = 0;
  for (unsigned coarserEdges = 1; coarserEdges < 1u << edges; ++coarserEdges) {
    TileMorph morph;
    morph.coarserEdges = static_cast<std::uint8_t>(coarserEdges);
    for (int edge = 0; edge < edges; ++edge)
      if (((coarserEdges >> edge) & 1u) != 0) morph.sides[static_cast<std::size_t>(edge)] = 1;
    TileMorph unstitched = morph;
    unstitched.coarserEdges = 0;
    const int digit = static_cast<int>(coarserEdges % 4);
    const Tile tile = smallTile(parentPath.child(digit), hilly, options);
    const GroundMesh mesh = GroundMesh::fromTile(tile), above = GroundMesh::fromTile(parent);
    for (int i = 0; i < 200; ++i) {
      const Place place = placeIn(tile.metadata.path, 0.01 + 0.98 * unit(random), 0.01 + 0.98 * unit(random));
      const auto expected = drawnHeight(tile, parent, morph, place.direction, radius);
      if (!expected) continue;  // beside the mesh
      ++compared;
      const auto of = [&](const TileMorph& drawn) {
        return mesh.morphedHeightMeters(place.direction, place.u, place.v, radius, drawn, above, digit).value_or(-1e9);
      };
      EXPECT_NEAR(of(morph), *expected, 4 * 2.3e-16 * radius) << coarserEdges << " at " << place.u << ", " << place.v;
      unstitchedDiffers = std::max(unstitchedDiffers, std::abs(of(unstitched) - *expected));
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(unstitchedDiffers, 5) << "the control";
}

INSTANTIATE_TEST_SUITE_P(Schemes, GroundMeshOfSchemes, test::bothSchemes(), test::nameOfScheme);

TEST(GroundMesh, AnEdgeThatIsTheParentsMeetsTheParentsSurface) {
  const FacePath path = *FacePath::parse("cube/2/0312");
  const SmallTileOptions options{testing::kMoonRadius, 8, false, false};
  const GroundMesh parent = GroundMesh::fromTile(smallTile(path, hilly, options));
  TileMorph morph;
  for (const Side side : {Side::UMin, Side::UMinVMin, Side::UMinVMax}) morph.sides[static_cast<std::size_t>(side)] = 1;
  for (const int digit : {1, 3}) {  // whose edge at u = 0 is in the parent's middle
    const GroundMesh mesh = GroundMesh::fromTile(smallTile(path.child(digit), hilly, options));
    double control = 0;
    for (double v = 0.03; v < 1; v += 0.05) {
      const Place place = placeIn(path.child(digit), 1e-6, v);
      const auto on = mesh.morphedHeightMeters(place.direction, place.u, v, testing::kMoonRadius, morph, parent, digit);
      const auto expected = parent.heightMeters(place.direction, 0.5, 0.5 * (v + (digit >> 1)), testing::kMoonRadius);
      ASSERT_TRUE(on && expected);
      EXPECT_NEAR(*on, *expected, 0.1) << "less than a metre inside the edge";
      control =
          std::max(control, std::abs(*mesh.heightMeters(place.direction, 0, v, testing::kMoonRadius) - *expected));
    }
    EXPECT_GT(control, 10) << "unmorphed it is elsewhere";
  }
}

TEST(GroundMesh, NothingMovesTowardsAParentThatDoesNotFit) {
  const FacePath path = *FacePath::parse("cube/2/0312");
  const GroundMesh mesh = GroundMesh::fromTile(smallTile(path, hilly));
  const GroundMesh other =
      GroundMesh::fromTile(smallTile(path.parent(), hilly, SmallTileOptions{testing::kMoonRadius, 8, false, false}));
  const Place place = placeIn(path, 0.3, 0.6);
  const auto own = mesh.heightMeters(place.direction, 0.3, 0.6, testing::kMoonRadius);
  for (const GroundMesh* parent : {&other, &mesh})
    EXPECT_EQ(mesh.morphedHeightMeters(place.direction, 0.3, 0.6, testing::kMoonRadius, everywhere(1), *parent, 2),
              own);
}

TEST(GroundMesh, AFlatSphereIsNeverAboveItsRadiusAndSagsByTheChord) {
  const FacePath path = *FacePath::parse("cube/2/0312");
  const GroundMesh mesh = GroundMesh::fromTile(smallTile(path, [](const glm::dvec3&) { return 0.0; }));
  const double cell = nominalTileWidthMeters(testing::kMoonRadius, 4) / testing::kSmallCells;
  const double sag = cell * cell / (4 * testing::kMoonRadius);  // half the diagonal, squared, over 2 R
  const double step = stepMeters(stepExponent(testing::kMoonRadius, 4));
  for (double u = 0.01; u < 1; u += 0.07) {
    for (double v = 0.01; v < 1; v += 0.07) {
      const Place place = placeIn(path, u, v);
      const auto height = mesh.heightMeters(place.direction, u, v, testing::kMoonRadius);
      ASSERT_TRUE(height);
      EXPECT_LE(*height, step);
      EXPECT_GE(*height, -1.05 * sag - step);
    }
  }
}

TEST(GroundMesh, UsesTheDiagonalThatIsDrawn) {
  // One corner of a cell is 100 m high: across the cell the two diagonals differ by half of that in the middle.
  const FacePath path = *FacePath::parse("cube/0/0123012301");
  const Place peak = placeIn(path, 0.25, 0.25);
  const auto spike = [&](const glm::dvec3& d) { return glm::dot(d, peak.direction) > 1 - 1e-12 ? 100.0 : 0.0; };
  const Place middle = placeIn(path, 0.375, 0.375);  // of the cell whose corner 00 is the peak
  SmallTileOptions options;
  const auto rising = GroundMesh::fromTile(smallTile(path, spike, options))
                          .heightMeters(middle.direction, middle.u, middle.v, testing::kMoonRadius);
  EXPECT_NEAR(*rising, 50.0, 1.0) << "the diagonal 00-11 goes up to the peak";
  const Place beside = placeIn(path, 0.125, 0.375);  // of the cell whose corner 10 is the peak
  const auto besideRising = GroundMesh::fromTile(smallTile(path, spike, options))
                                .heightMeters(beside.direction, beside.u, beside.v, testing::kMoonRadius);
  EXPECT_NEAR(*besideRising, 0.0, 1.0);
  options.alternateDiagonals = true;  // the cell (0, 1) has the other diagonal, 10-01
  const auto besideFalling = GroundMesh::fromTile(smallTile(path, spike, options))
                                 .heightMeters(beside.direction, beside.u, beside.v, testing::kMoonRadius);
  EXPECT_NEAR(*besideFalling, 50.0, 1.0);
}

TEST(GroundMesh, RefusesIncompleteGrids) {
  const FacePath path = *FacePath::parse("cube/1/2");
  const Tile whole = smallTile(path, hilly);
  EXPECT_FALSE(GroundMesh::fromTile(whole).empty());
  Tile broken = whole;
  broken.mesh.gridIndices[3] = 9999;
  EXPECT_TRUE(GroundMesh::fromTile(broken).empty());
  broken = whole;
  broken.mesh.offsets.pop_back();
  EXPECT_TRUE(GroundMesh::fromTile(broken).empty());
  broken = whole;
  broken.metadata.cellsPerEdge = 0;
  EXPECT_TRUE(GroundMesh::fromTile(broken).empty());
  broken = whole;
  broken.mesh.triangles[0] = 1'000'000;
  EXPECT_FALSE(GroundMesh::fromTile(broken).empty()) << "a triangle that names no vertex is skipped";
  EXPECT_FALSE(GroundMesh().heightMeters({0, 0, 1}, 0.5, 0.5, 1.0));
}

TEST(GroundMesh, KeepsSixBytesAVertex) {
  const GroundMesh mesh = GroundMesh::fromTile(
      smallTile(*FacePath::parse("cube/1/2"), hilly, SmallTileOptions{testing::kMoonRadius, 64, false, false}));
  EXPECT_LE(mesh.bytes(), 6u * 65 * 65 + 64 * 64 / 8 + 200);
}

}  // namespace
}  // namespace terrane

// Ground by midpoint displacement is what its definition says, for a tile as for an edge and a direction, at all levels
// and over all edges of the solid.

#include "server/fields/midpoint_field.h"

#include <bit>
#include <cstdio>
#include <map>
#include <tuple>

#include "common/tiling/tile_neighbours.h"
#include "server/fields/midpoint_gradient.h"
#include "server/fields/midpoint_keys.h"
#include "tests/unit/fields/midpoint_ground.h"

namespace terrane {
namespace {

using namespace test;

INSTANTIATE_TEST_SUITE_P(Schemes, MidpointGround, bothSchemes(), nameOfScheme);

/// The definition, word for word: a vertex of a whole face, by recursion up to the corners of the solid.
class Definition {
 public:
  explicit Definition(const Body& body) : scheme_(body.schemes.front()), displacement_(displacementOf(body)) {}

  double height(int face, int gridLevel, std::int64_t i, std::int64_t j) {
    const auto [known, fresh] = heights_.try_emplace({face, gridLevel, i, j}, 0);
    if (!fresh) return known->second;
    const double height = compute(face, gridLevel, i, j);
    return heights_[{face, gridLevel, i, j}] = height;
  }

 private:
  VertexKey key(int face, int gridLevel, std::int64_t i, std::int64_t j) const {
    if (scheme_ == Scheme::Cube) return cubeVertexKey(face, gridLevel, i, j);
    return icoVertexKey(face, {(std::int64_t{1} << gridLevel) - i - j, i, j});
  }
  double compute(int face, int gridLevel, std::int64_t i, std::int64_t j) {
    const double moved = displacement_.meters(gridLevel, key(face, gridLevel, i, j));
    if (gridLevel == 0) return moved;
    const auto above = [&](std::int64_t di, std::int64_t dj) {
      return height(face, gridLevel - 1, (i + di) / 2, (j + dj) / 2);
    };
    const bool oddI = i % 2 != 0, oddJ = j % 2 != 0;
    if (!oddI && !oddJ) return above(0, 0);
    if (!oddJ) return (above(-1, 0) + above(1, 0)) / 2 + moved;
    if (!oddI) return (above(0, -1) + above(0, 1)) / 2 + moved;
    if (scheme_ == Scheme::Ico) return (above(-1, 1) + above(1, -1)) / 2 + moved;
    return ((above(-1, -1) + above(1, 1)) + (above(-1, 1) + above(1, -1))) / 4 + moved;
  }

  Scheme scheme_;
  MidpointDisplacement displacement_;
  std::map<std::tuple<int, int, std::int64_t, std::int64_t>, double> heights_;
};

TEST_P(MidpointGround, OfATileIsTheDefinitionsToTheBit) {
  Definition definition(body_);
  for (int level = 0; level <= FacePath::kMaxLevel; ++level) {
    const int cells = 1 << (level % 8);
    const FacePath path = randomTileOf(random_, scheme(), level);
    const SurfaceSamples samples = sampledTile(*field_, body_, path, cells);
    std::size_t at = 0;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= (scheme() == Scheme::Ico ? cells - j : cells); ++i, ++at) {
        const auto [faceI, faceJ] = placeOnFace(path, cells, i, j);
        ASSERT_EQ(samples.heightMeters[at], definition.height(path.face(), level + levelsOf(cells), faceI, faceJ))
            << path.text() << " " << i << "," << j;
      }
    }
    ASSERT_EQ(at, samples.heightMeters.size());
  }
}

/// Along each edge of a tile, as skirts ask for it, coarser and finer by a level too.
TEST_P(MidpointGround, AlongAnEdgeIsTheGrids) {
  for (int level = 1; level <= 29; level += 2) {
    const FacePath path = randomTileOf(random_, scheme(), level);
    for (const int cells : {4, 8, 16}) {
      const SurfaceSamples grid = sampledTile(*field_, body_, path, cells);
      for (int edge = 0; edge < edgeCount(scheme()); ++edge) {
        const SurfaceSamples along = sampledTile(*field_, body_, path, cells, edge);
        ASSERT_EQ(along.heightMeters.size(), static_cast<std::size_t>(cells) + 1);
        for (int k = 0; k <= cells; ++k) {
          const int side = cells + 1, back = cells - k;
          const std::array<int, 4> ofCube{k, k * side + cells, cells * side + back, back * side};
          const int index = scheme() == Scheme::Cube ? ofCube[static_cast<std::size_t>(edge)]
                                                     : triangleGridIndex(cells, edgeVertex(cells, edge, k));
          ASSERT_EQ(along.heightMeters[static_cast<std::size_t>(k)], grid.heightMeters[static_cast<std::size_t>(index)])
              << path.text() << " edge " << edge;
        }
      }
    }
  }
}

/// A grid that is finer than the wavelength asked for has the coarser surface's heights.
TEST_P(MidpointGround, AtALongerWavelengthIsTheCoarserSurface) {
  for (int level = 3; level <= 27; level += 3) {
    const FacePath path = randomTileOf(random_, scheme(), level);
    const std::vector<glm::dvec3> points = directionsOf(path, 8);
    for (const int gridLevel : {level - 2, level + 1}) {
      const SurfaceSamples coarse = sampledPoints(*field_, body_, points, gridLevel);
      const SurfaceSamples grid = sampledTile(*field_, body_, path, 8, GridPlace::kWholeGrid, gridLevel);
      const SurfaceSamples edge = sampledTile(*field_, body_, path, 8, 0, gridLevel);
      const SurfaceSamples fine = sampledTile(*field_, body_, path, 8);
      for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_NEAR(grid.heightMeters[i], coarse.heightMeters[i], 2e-7) << path.text();
      EXPECT_NE(grid.heightMeters, fine.heightMeters);
      const auto end = static_cast<std::size_t>(scheme() == Scheme::Cube ? 0 : 8);  // where edge 0 begins
      EXPECT_EQ(edge.heightMeters.front(), grid.heightMeters[end]);
    }
  }
}

/// A vertex that a tile has in common with its parent has one height in both.
TEST_P(MidpointGround, KeepsAVertexHeightAtAllFinerLevels) {
  const int cells = 16;
  for (int level = 0; level < FacePath::kMaxLevel; ++level) {
    const FacePath path = randomTileOf(random_, scheme(), level);
    const SurfaceSamples parent = sampledTile(*field_, body_, path, cells);
    int moved = 0;
    for (int digit = 0; digit < 4; ++digit) {
      const SurfaceSamples child = sampledTile(*field_, body_, path.child(digit), cells);
      std::size_t at = 0;
      for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= (scheme() == Scheme::Ico ? cells - j : cells); ++i, ++at) {
          const bool cube = scheme() == Scheme::Cube;
          const auto [a, b] = parentGridVertices(digit, cells, {i, j});
          const std::array<int, 2> cubeParent{(digit & 1) * cells / 2 + i / 2, (digit >> 1) * cells / 2 + j / 2};
          const auto above = static_cast<std::size_t>(cube ? cubeParent[1] * (cells + 1) + cubeParent[0]
                                                           : triangleGridIndex(cells, a));
          if (i % 2 == 0 && j % 2 == 0) {
            ASSERT_EQ(child.heightMeters[at], parent.heightMeters[above]) << path.text() << " child " << digit;
          } else {
            moved += child.heightMeters[at] != parent.heightMeters[above] ? 1 : 0;
          }
        }
      }
    }
    EXPECT_GT(moved, 100) << "the control: others have heights of their own";
  }
}

/// The direction of a vertex gives its height but for what rounding moves the direction along the ground: some 1e-14
/// of the radius at a slope of at most 5, and so much less than a lattice step.
TEST_P(MidpointGround, AtAVertexDirectionIsTheVertexHeight) {
  double worst = 0;
  for (int level = 0; level <= 30; level += 3) {
    const FacePath path = randomTileOf(random_, scheme(), level);
    const std::vector<glm::dvec3> points = directionsOf(path, 8);
    const SurfaceSamples grid = sampledTile(*field_, body_, path, 8);
    const SurfaceSamples single = sampledPoints(*field_, body_, points, level + 3);
    for (std::size_t i = 0; i < points.size(); ++i)
      worst = std::max(worst, std::abs(single.heightMeters[i] - grid.heightMeters[i]));
  }
  std::printf("at most %.3g m from the vertex' own height\n", worst);
  EXPECT_LT(worst, 5 * 2e-14 * kMoonRadius);
}

using Bits = std::array<std::uint64_t, 3>;
Bits bitsOf(const glm::dvec3& direction) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };  // one zero
  return {bits(direction.x), bits(direction.y), bits(direction.z)};
}

struct VertexSample {
  double heightMeters;
  std::array<float, 3> gradient;
  bool operator==(const VertexSample&) const = default;
};

/// All of a tile's samples by the bits of their directions, which tiles share.
std::map<Bits, VertexSample> samplesByDirection(const HeightField& field, const Body& body, const FacePath& path) {
  const int cells = 8;
  const SurfaceSamples samples = sampledTile(field, body, path, cells);
  const std::vector<glm::dvec3> at = directionsOf(path, cells);
  std::map<Bits, VertexSample> out;
  for (std::size_t i = 0; i < at.size(); ++i) {
    out[bitsOf(at[i])] = {samples.heightMeters[i], {samples.gradientX[i], samples.gradientY[i], samples.gradientZ[i]}};
  }
  return out;
}

/// At all corners of all faces, and at random.
std::vector<FacePath> tilesOfAllKinds(Scheme scheme, std::mt19937_64& random) {
  std::vector<FacePath> tiles;
  for (int face = 0; face < faceCount(scheme); ++face)
    for (int corner = 0; corner < edgeCount(scheme); ++corner) {
      FacePath path = FacePath::wholeFace(scheme, face);
      for (int level = 0; level <= 30; ++level) {
        if (level % 6 == 0) tiles.push_back(path);
        if (level < 30) path = path.child(corner);
      }
    }
  for (int k = 0; k < 300; ++k) tiles.push_back(randomTileOf(random, scheme, k % 31));
  return tiles;
}

TEST_P(MidpointGround, GivesSharedVerticesTheSameBitsInAllTiles) {
  const std::vector<FacePath> tiles = tilesOfAllKinds(scheme(), random_);
  std::size_t shared = 0;
  for (const FacePath& path : tiles) {
    const auto own = samplesByDirection(*field_, body_, path);
    for (const FacePath& beside : tilesAround(path)) {
      for (const auto& [direction, sample] : samplesByDirection(*field_, body_, beside)) {
        const auto same = own.find(direction);
        if (same == own.end()) continue;
        ++shared;
        ASSERT_EQ(same->second, sample) << path.text() << " and " << beside.text();
      }
    }
  }
  EXPECT_GT(shared, tiles.size() * 9 * 3);
}

/// Gradients in double, of which the samples are the nearest floats: all but one in millions of these would agree
/// whatever the order of the sums.
template <class Tiling>
std::map<Bits, std::array<double, 3>> gradientsByDirection(const Body& body, const FacePath& path) {
  const int cells = 4;
  const MidpointDisplacement displacement = displacementOf(body);
  midpoint::Subdivision<Tiling> subdivision;
  subdivision.start(displacement, MidpointDisplacement::kFinestGridLevel, path.face(), 1);
  subdivision.enter(path);
  while (subdivision.places().cells() < cells) subdivision.halveCells();
  midpoint::addDirections(subdivision);
  const std::vector<glm::dvec3> at = directionsOf(path, cells);
  std::map<Bits, std::array<double, 3>> out;
  std::size_t index = 0;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= Tiling::lastI(cells, j, 0); ++i, ++index) {
      EXPECT_EQ(subdivision.places().at(i, j).direction, at[index]) << "what the builder has";
      const glm::dvec3 gradient = midpoint::gradientAt<Tiling>(subdivision.places(), i, j, body.radiusMeters);
      out[bitsOf(at[index])] = {gradient.x, gradient.y, gradient.z};
    }
  }
  return out;
}

TEST_P(MidpointGround, GivesSharedVerticesOneGradientToTheLastBitOfADouble) {
  const auto gradients = [&](const FacePath& path) {
    return scheme() == Scheme::Ico ? gradientsByDirection<midpoint::IcoTiling<true>>(body_, path)
                                   : gradientsByDirection<midpoint::CubeTiling>(body_, path);
  };
  for (const FacePath& path : tilesOfAllKinds(scheme(), random_)) {
    const auto own = gradients(path);
    for (const FacePath& beside : tilesAround(path))
      for (const auto& [direction, gradient] : gradients(beside)) {
        const auto same = own.find(direction);
        if (same == own.end()) continue;
        ASSERT_EQ(same->second, gradient) << path.text() << " and " << beside.text();
      }
  }
}

/// The mean of the gradients of the triangles around a vertex, by their areas, in space.
glm::dvec3 gradientOfTriangles(const glm::dvec3& here, double height, const std::vector<glm::dvec3>& beside,
                               const std::vector<double>& heights) {
  glm::dvec3 sum(0.0);
  double areas = 0;
  for (std::size_t k = 0; k < beside.size(); ++k) {
    const std::size_t next = (k + 1) % beside.size();
    const glm::dvec3 a = (beside[k] - here) * kMoonRadius, b = (beside[next] - here) * kMoonRadius;
    const glm::dvec3 normal = glm::cross(a, b);
    const double area = glm::length(normal);
    // The vector in the triangle's plane whose product with a and b is what the height rises by.
    sum += glm::cross(b * (heights[k] - height) - a * (heights[next] - height), normal) / area;
    areas += area;
  }
  return sum / areas;
}

/// Up to what the ground curves within a cell.
TEST_P(MidpointGround, HasTheGradientOfItsMesh) {
  const bool ico = scheme() == Scheme::Ico;
  using Steps = std::vector<std::array<int, 2>>;
  const Steps steps =
      ico ? Steps{{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}} : Steps{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (int level = 0; level <= 28; level += 4) {
    const int cells = 32;
    const FacePath path = randomTileOf(random_, scheme(), level);
    const SurfaceSamples samples = sampledTile(*field_, body_, path, cells);
    const std::vector<glm::dvec3> at = directionsOf(path, cells);
    const double curved = nominalTileWidthMeters(1.0, level, scheme()) / cells;
    double off = 0, slopes = 0;
    for (int j = 1; j < cells; ++j) {
      for (int i = 1; i < (ico ? cells - j : cells); ++i) {
        const auto index = [&](int di, int dj) {
          return static_cast<std::size_t>(ico ? triangleGridIndex(cells, {i + di, j + dj})
                                              : (j + dj) * (cells + 1) + i + di);
        };
        std::vector<glm::dvec3> beside;
        std::vector<double> heights;
        for (const auto& [di, dj] : steps) {
          beside.push_back(at[index(di, dj)]);
          heights.push_back(samples.heightMeters[index(di, dj)]);
        }
        const std::size_t here = index(0, 0);
        const glm::dvec3 expected = gradientOfTriangles(at[here], samples.heightMeters[here], beside, heights);
        const glm::dvec3 gradient(samples.gradientX[here], samples.gradientY[here], samples.gradientZ[here]);
        ASSERT_LT(std::abs(glm::dot(gradient, at[here])), 1e-6) << "along the sphere";
        off = std::max(off, glm::length(gradient - expected));
        slopes = std::max(slopes, glm::length(expected));
      }
    }
    EXPECT_LT(off, (2 * curved + 1e-4) * slopes) << path.text();
  }
}

TEST(MidpointField, IsAnotherGroundForEverySetting) {
  const Body body = midpointBody(Scheme::Ico, kMoonRadius, 1, 0.5);
  const auto field = makeHeightField(body, bestSimdPath());
  const auto differs = [&](const Body& other) {
    const auto changed = makeHeightField(other, bestSimdPath());
    EXPECT_NE(changed->identity(), field->identity());
    const FacePath path = *FacePath::parse("ico/7/0123");
    EXPECT_NE(sampledTile(*changed, other, path, 8).heightMeters, sampledTile(*field, body, path, 8).heightMeters);
  };
  Body other = body;
  other.seed += 1;
  differs(other);
  other = body;
  other.fieldParameters["amplitude"] *= 1.001;
  differs(other);
  other = body;
  other.fieldParameters["regularity"] = 1.01;
  differs(other);
}

}  // namespace
}  // namespace terrane

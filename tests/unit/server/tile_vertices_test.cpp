// A tile's vertex attributes against the plainest arithmetic.

#include "server/build/tile_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "proto/tile_mesh.h"
#include "server/build/edge_planes.h"

namespace terrane {
namespace {

constexpr double kRadiusMeters = 1.7374e6;

struct Ground {
  FacePath path;
  int cells = 64;
  std::shared_ptr<const TileTopology> topology;
  GridDirections directions;
  SurfaceSamples samples;
  std::vector<double> skirtHeights;
};

/// Rough, and steep as no field is.
Ground randomGround(FacePath path, int level, int cells, std::mt19937_64& random) {
  while (path.level() < level) path = path.child(static_cast<int>(random() % 4));
  Ground ground{path, cells, makeTileTopology(path.scheme(), cells), {}, {}, {}};
  gridDirections(path, cells, ground.directions);
  const double width = nominalTileWidthMeters(kRadiusMeters, level, path.scheme());
  std::uniform_real_distribution<double> height(-0.02 * width, 0.02 * width);
  std::uniform_real_distribution<float> slope(-5.0f, 5.0f), reflectance(-0.1f, 1.2f * kColorScale);
  for (std::size_t i = 0; i < ground.directions.x.size(); ++i) {
    ground.samples.heightMeters.push_back(height(random));
    ground.samples.gradientX.push_back(slope(random));
    ground.samples.gradientY.push_back(slope(random));
    ground.samples.gradientZ.push_back(slope(random));
    ground.samples.reflectance.push_back(reflectance(random));
  }
  for (std::size_t k = 0; k < ground.topology->skirtAnchors.size(); ++k) ground.skirtHeights.push_back(height(random));
  return ground;
}

std::vector<Ground> randomGrounds() {
  std::mt19937_64 random(31);
  std::vector<Ground> grounds;
  for (int level = 0; level <= 18; level += 2) {
    const int cells = 2 << (level / 2 % 6);
    grounds.push_back(randomGround(FacePath::wholeFace(Scheme::Cube, level % 6), level, cells, random));
    grounds.push_back(randomGround(FacePath::wholeFace(Scheme::Ico, level), level, cells, random));
  }
  return grounds;
}

glm::dvec3 directionOf(const Ground& ground, std::size_t vertex) {
  return {ground.directions.x[vertex], ground.directions.y[vertex], ground.directions.z[vertex]};
}

TEST(TileVertices, StandWhereRoundToLatticePutsThem) {
  for (const Ground& ground : randomGrounds()) {
    const int exponent = stepExponent(kRadiusMeters, ground.path.level(), ground.path.scheme());
    const TileTopology& topology = *ground.topology;
    LatticeCoordinates lattice;
    placeVertices({ground.path, topology, ground.directions, ground.samples.heightMeters, ground.skirtHeights,
                   kRadiusMeters, exponent},
                  lattice);
    ASSERT_EQ(lattice.x.size(), topology.gridIndices.size());
    LatticePoint origin;
    std::vector<std::uint16_t> offsets;
    ASSERT_TRUE(offsetsFromOrigin(lattice, origin, offsets)) << ground.path.text();

    const EdgeNormals outward(ground.path);
    const std::size_t gridCount = topology.gridVertexCount(), perEdge = static_cast<std::size_t>(ground.cells) + 1;
    glm::i64vec3 least(kTileOffsetMax);
    for (std::size_t vertex = 0; vertex < topology.gridIndices.size(); ++vertex) {
      const bool skirt = vertex >= gridCount;
      const std::size_t k = vertex - gridCount, at = skirt ? topology.skirtAnchors[k] : vertex;
      const double height = skirt ? ground.skirtHeights[k] : ground.samples.heightMeters[vertex];
      glm::dvec3 position = directionOf(ground, at) * (kRadiusMeters + height);
      if (skirt)
        position += outward.lean(k / perEdge, k % perEdge, perEdge - 1) * (kSkirtFlareSteps * stepMeters(exponent));
      const LatticePoint offset(offsets[3 * vertex], offsets[3 * vertex + 1], offsets[3 * vertex + 2]);
      ASSERT_EQ(origin + offset, roundToLattice(position, exponent)) << ground.path.text() << ", " << vertex;
      for (int axis = 0; axis < 3; ++axis) least[axis] = std::min(least[axis], offset[axis]);
    }
    EXPECT_EQ(least, glm::i64vec3(0));
  }
}

TEST(TileVertices, ThatDoNotFitIntoSixteenBitsAreTold) {
  const double first = -1e9;
  for (const double extent : {65535.0, 65536.0}) {
    LatticePoint origin;
    std::vector<std::uint16_t> offsets;
    const std::vector<double> flat(3, first);
    EXPECT_EQ(offsetsFromOrigin({flat, {first + extent, first, first}, flat}, origin, offsets), extent == 65535.0);
  }
}

TEST(TileVertices, HaveNormalsThatDifferLittleFromThoseInDouble) {
  double worst = 0;
  for (const Ground& ground : randomGrounds()) {
    std::vector<float> normals;
    writeNormals(ground.directions, ground.samples, kRadiusMeters, *ground.topology, normals);
    ASSERT_EQ(normals.size(), 3 * ground.topology->gridIndices.size());
    const std::size_t gridCount = ground.topology->gridVertexCount();
    for (std::size_t vertex = 0; vertex < ground.topology->gridIndices.size(); ++vertex) {
      const std::size_t at = vertex < gridCount ? vertex : ground.topology->skirtAnchors[vertex - gridCount];
      const SurfaceSamples& samples = ground.samples;
      const glm::dvec3 gradient(samples.gradientX[at], samples.gradientY[at], samples.gradientZ[at]);
      const glm::dvec3 n = directionOf(ground, at) * (1.0 + samples.heightMeters[at] / kRadiusMeters) - gradient;
      const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
      if (length < 0.05) continue;  // as good as none: a tangent gradient leaves at least 1
      for (int axis = 0; axis < 3; ++axis)
        worst = std::max(worst, std::abs(n[axis] / length - static_cast<double>(normals[3 * vertex + axis])) *
                                    std::min(1.0, length));
    }
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 1e-6);
}

TEST(TileVertices, HaveTheNearestGreyWithinAByte) {
  for (const Ground& ground : randomGrounds()) {
    std::vector<std::uint8_t> colors;
    writeColors(ground.samples.reflectance, *ground.topology, colors);
    ASSERT_EQ(colors.size(), 3 * ground.topology->gridIndices.size());
    const std::size_t gridCount = ground.topology->gridVertexCount();
    for (std::size_t vertex = 0; vertex < ground.topology->gridIndices.size(); ++vertex) {
      const std::size_t at = vertex < gridCount ? vertex : ground.topology->skirtAnchors[vertex - gridCount];
      const float scaled = std::floor(ground.samples.reflectance[at] * (255.0f / kColorScale) + 0.5f);
      for (std::size_t channel = 0; channel < 3; ++channel)
        ASSERT_EQ(static_cast<float>(colors[3 * vertex + channel]), std::clamp(scaled, 0.0f, 255.0f));
    }
  }
}

TEST(TileVertices, RangesFindTheEndsWhereverTheyAre) {
  for (std::size_t count = 1; count < 8; ++count) {
    for (std::size_t low = 0; low < count; ++low) {
      for (std::size_t high = 0; high < count; ++high) {
        if (low == high) continue;
        std::vector<double> numbers(count, 1.0);
        numbers[low] = -3.0;
        numbers[high] = 4.0;
        const NumberRange range = rangeOf(numbers);
        EXPECT_EQ(range.least, -3.0);
        EXPECT_EQ(range.greatest, 4.0);
      }
    }
  }
  const std::vector<double> one{7.0};
  EXPECT_EQ(rangeOf(one).least, 7.0);
}

}  // namespace
}  // namespace terrane

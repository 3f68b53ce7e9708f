// What the figures of `projection` rest on: shapes of cells, where a tile's mesh is, what a tile weighs, what a coarser
// error does.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/icosahedron.h"
#include "server/build/tile_topology.h"
#include "tests/accuracy/projection/descent_comparison.h"
#include "tests/accuracy/projection/sphere_maps.h"

namespace terrane::accuracy {
namespace {

constexpr unsigned kSeed = 5;

CellShapes shapesOf(std::string_view name) {
  return std::ranges::find(sphereMaps(), name, &SphereMap::name)->shapes(256);
}

TEST(Projection, CellsOfTheThreeMapsAreAsTheoryHasThem) {
  const CellShapes cube = shapesOf(kCubeMapName), bisected = shapesOf(kBisectedMapName),
                   gnomonic = shapesOf(kGnomonicMapName);
  // The middle of an edge of the equi-angular cube against the middle of a face: a factor of sqrt 2.
  EXPECT_NEAR(cube.areaRatio, std::sqrt(2.0), 0.01);
  EXPECT_NEAR(cube.longestEdge, 1.0, 1e-4);
  EXPECT_NEAR(cube.mostAngle, 120, 0.5);
  EXPECT_NEAR(bisected.areaRatio, 1.3005, 0.001);  // as ico_shapes_test has it
  EXPECT_NEAR(gnomonic.areaRatio, std::pow(kIcosahedronInradius, -3), 0.02);
  for (const CellShapes& shapes : {bisected, gnomonic}) {
    EXPECT_NEAR(shapes.leastAngle, 54, 0.01);
    EXPECT_NEAR(shapes.mostAngle, 72, 0.01);
    EXPECT_EQ(shapes.leastAngle, shapes.leastDrawnAngle) << "its cells are its triangles";
  }
}

TEST(Projection, PlacesAreWhatTheyAreCalled) {
  const std::vector<Place> places = descentPlaces(kSeed, 3);
  const FaceCoordinates middle = cubeFaceCoordinates(places[0].direction),
                        edge = cubeFaceCoordinates(places[3].direction);
  EXPECT_EQ(std::fabs(middle.s) + std::fabs(middle.t), 0);
  EXPECT_EQ(places[1].direction, icosahedronVertex(0));
  const glm::dvec3& corner = places[2].direction;
  EXPECT_TRUE(corner.x == corner.y && corner.y == corner.z);
  EXPECT_EQ(std::fabs(edge.s) + std::fabs(edge.t), 1);
  ASSERT_EQ(places.size(), 7u);
  for (const Place& place : places) EXPECT_NEAR(glm::length(place.direction), 1, 1e-15) << place.name;
}

/// Of both schemes.
class ProjectionTiles : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ProjectionTiles, testing::Values("moon", "moon-ico"),
                         [](const auto& scene) { return scene.param == std::string("moon") ? "Cube" : "Ico"; });

TEST_P(ProjectionTiles, TheMeshIsMetInTheTriangleThatHoldsTheDirection) {
  DescentTiles tiles(GetParam());
  const int cells = tiles.builder().info().cellsPerEdge;
  const auto topology = makeTileTopology(tiles.scheme(), cells);
  const std::size_t inGrid = gridVertexCount(tiles.scheme(), cells);
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  for (const int level : {0, 3, 11, 20}) {
    const FacePath path = tileAt(tiles.scheme(), descentPlaces(kSeed, 1).back().direction, level);
    const MeshedTile& tile = tiles.tile(path);
    const auto position = [&](std::uint32_t vertex) {
      const std::uint16_t* offset = &tile.offsets[3 * vertex];
      return stepMeters(tile.stepExponent) * glm::dvec3(tile.origin + LatticePoint(offset[0], offset[1], offset[2]));
    };
    for (int n = 0; n < 300; ++n) {
      const std::uint32_t* corners = &topology->triangles[3 * (random() % (topology->triangles.size() / 3))];
      if (std::any_of(corners, corners + 3, [&](std::uint32_t v) { return v >= inGrid; })) continue;  // of a skirt
      const glm::dvec3 middle = (position(corners[0]) + position(corners[1]) + position(corners[2])) / 3.0;
      const double radius = glm::length(middle);
      EXPECT_NEAR(meshRadiusMeters(path, tile, cells, middle / radius), radius, 1e-8) << path.text();
    }
  }
}

TEST_P(ProjectionTiles, ATileWeighsWhatIsServed) {
  DescentTiles tiles(GetParam());
  const FacePath path = tileAt(tiles.scheme(), {0.6, 0, 0.8}, 9);
  const Amounts& amounts = tiles.tile(path).amounts;
  EXPECT_EQ(static_cast<std::size_t>(amounts.bytes), tiles.builder().build(path).value().glb.size());
  EXPECT_LT(amounts.dracoBytes, amounts.bytes);
  EXPECT_EQ(static_cast<std::size_t>(amounts.vertices), tiles.builder().buildMesh(path).value().mesh.vertexCount());
}

TEST(Projection, ACoarserErrorFetchesLessAndDrawsWorseInBothSchemes) {
  DescentTiles cube("moon"), ico("moon-ico");
  const auto moon = makeHeightField(cube.builder().body(), bestSimdPath());
  const Place place = descentPlaces(kSeed, 1).back();
  const SchemeOutcomes outcomes = compareDescents(
      descentCameras(place, *moon, cube.builder().body().radiusMeters, 5, 640, 360), *moon, {&cube, &ico});
  for (std::size_t s = 0; s < kSchemes; ++s) {
    const Outcome &fine = outcomes.byError[0][s], &coarse = outcomes.byError[1][s];
    EXPECT_LT(coarse.fetched.tiles, fine.fetched.tiles);
    EXPECT_GT(coarse.meanErrorPixels(), fine.meanErrorPixels());
    EXPECT_GT(fine.points, 1000);
    for (const Outcome& outcome : {fine, coarse})
      EXPECT_NEAR(
          bytesForError(outcomes, s, outcome.meanErrorPixels()).value() / static_cast<double>(outcome.fetched.bytes), 1,
          1e-12);
  }
}

}  // namespace
}  // namespace terrane::accuracy

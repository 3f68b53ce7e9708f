#pragma once
// Bodies of midpoint displacement and what their field gives for tiles, edges and directions, in either scheme.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "common/tiling/ico_sphere.h"
#include "server/fields/midpoint_field.h"
#include "tests/support/both_schemes.h"
#include "tests/support/ico_points.h"
#include "tests/unit/fields/field_samples.h"

namespace terrane::test {

inline constexpr std::uint64_t kGroundSeed = 1982;

/// amplitude: of what the body may have at most.
inline Body midpointBody(Scheme scheme, double radiusMeters = kMoonRadius, double regularity = 1,
                         double amplitude = 1) {
  Body body = tiledBy(scheme, testBody(FieldKind::Midpoint, radiusMeters, kGroundSeed));
  body.fieldParameters["amplitude"] = amplitude * mostAmplitudeMeters(radiusMeters, scheme, regularity);
  body.fieldParameters["regularity"] = regularity;
  return body;
}

inline MidpointDisplacement displacementOf(const Body& body) {
  return {body.fieldParameters.at("amplitude"), body.fieldParameters.at("regularity"), body.seed};
}

inline FacePath randomTileOf(std::mt19937_64& random, Scheme scheme, int level) {
  if (scheme == Scheme::Ico) return randomIcoTile(random, level);
  FacePath path = FacePath::wholeFace(scheme, static_cast<int>(random() % 6));
  // Each third tile keeps to an edge or corner of its face for many levels.
  const int digit = static_cast<int>(random() % 4), other = digit ^ (random() % 2 != 0 ? 1 : 2);
  const bool atEdge = random() % 3 == 0;
  while (path.level() < level)
    path = path.child(atEdge ? (random() % 2 != 0 ? digit : other) : static_cast<int>(random() % 4));
  return path;
}

inline double cellMeters(const Body& body, int gridLevel) {
  return nominalTileWidthMeters(body.radiusMeters, 0, body.schemes.front()) * std::ldexp(1.0, -gridLevel);
}

inline int levelsOf(int cells) {
  int levels = 0;
  while (1 << levels < cells) ++levels;
  return levels;
}

/// As the builder asks for a tile, or, with an edge, as the skirts ask; or of the surface of another grid level. Needs
/// no directions.
inline SurfaceSamples sampledTile(const HeightField& field, const Body& body, const FacePath& path, int cells,
                                  int edge = GridPlace::kWholeGrid, int gridLevel = -1) {
  const auto side = static_cast<std::size_t>(cells) + 1;
  SampleBatch batch;
  batch.rowLength = side;
  batch.rows = edge == GridPlace::kWholeGrid ? side : 1;
  if (edge == GridPlace::kWholeGrid && path.scheme() == Scheme::Ico) {
    batch.rowLength = static_cast<std::size_t>(triangleGridSize(cells));
    batch.rows = 1;
  }
  batch.grid = GridPlace{path, cells, edge};
  SurfaceSamples samples;
  if (gridLevel < 0) gridLevel = path.level() + levelsOf(cells);
  field.evaluate(batch, 2.0 * cellMeters(body, gridLevel), samples);
  return samples;
}

/// The place on its whole face of a vertex of a tile's grid.
inline std::array<std::int64_t, 2> placeOnFace(const FacePath& path, int cells, int i, int j) {
  if (path.scheme() == Scheme::Cube)
    return {std::int64_t{path.column()} * cells + i, std::int64_t{path.row()} * cells + j};
  const FaceWeights weights = gridVertexWeights(triangleTile(path), cells, {i, j});
  return {weights.y, weights.z};
}

/// The directions of all vertices of a tile's grid, by grid index.
inline std::vector<glm::dvec3> directionsOf(const FacePath& path, int cells) {
  const auto count = static_cast<std::size_t>(triangleGridSize(cells));
  std::vector<glm::dvec3> out;
  if (path.scheme() == Scheme::Cube) {
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const auto [faceI, faceJ] = placeOnFace(path, cells, i, j);
        out.push_back(cubeGridDirection(path.face(), path.level() + levelsOf(cells), static_cast<std::uint64_t>(faceI),
                                        static_cast<std::uint64_t>(faceJ)));
      }
    return out;
  }
  std::vector<double> x(count), y(count), z(count);
  icoGridDirections(kIcoMap, path, cells, {x, y, z});
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(x[i], y[i], z[i]);
  return out;
}

/// Samples of single directions, of the surface of a grid level.
inline SurfaceSamples sampledPoints(const HeightField& field, const Body& body, const std::vector<glm::dvec3>& points,
                                    int gridLevel) {
  Directions directions;
  for (const glm::dvec3& point : points) directions.add(point);
  return evaluate(field, directions, 2.0 * cellMeters(body, gridLevel));
}

/// Suites over both schemes, on the largest ground that a body of the Moon's size may have.
class MidpointGround : public testing::TestWithParam<Scheme> {
 protected:
  Scheme scheme() const { return GetParam(); }
  Body body_ = midpointBody(GetParam());
  std::unique_ptr<const HeightField> field_ = makeHeightField(body_, bestSimdPath());
  std::mt19937_64 random_{kGroundSeed};
};

}  // namespace terrane::test

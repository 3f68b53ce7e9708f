#include "tests/unit/client/small_tiles.h"

#include <algorithm>
#include <bit>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <mutex>
#include <numeric>
#include <random>
#include <stdexcept>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_bounds.h"

namespace terrane::testing {

Tile smallTile(const FacePath& path, const HeightFormula& height, const SmallTileOptions& options) {
  const int cells = options.cells, row = cells + 1;
  const int gridLevel = path.level() + std::countr_zero(static_cast<unsigned>(cells));
  const auto vertices = static_cast<std::size_t>(row * row);
  const int exponent = stepExponent(options.radiusMeters, path.level());

  std::vector<LatticePoint> points;
  LatticePoint lowest(std::numeric_limits<std::int64_t>::max());
  for (int j = 0; j < row; ++j) {
    for (int i = 0; i < row; ++i) {
      const auto column =
          static_cast<std::uint64_t>(path.column()) * static_cast<std::uint64_t>(cells) + static_cast<std::uint64_t>(i);
      const auto line =
          static_cast<std::uint64_t>(path.row()) * static_cast<std::uint64_t>(cells) + static_cast<std::uint64_t>(j);
      const glm::dvec3 direction = cubeGridDirection(path.face(), gridLevel, column, line);
      points.push_back(roundToLattice((options.radiusMeters + height(direction)) * direction, exponent));
      lowest = glm::min(lowest, points.back());
    }
  }

  std::vector<std::size_t> place(vertices);  // of a grid vertex in the mesh
  std::iota(place.begin(), place.end(), std::size_t{0});
  if (options.shuffleVertices) std::shuffle(place.begin(), place.end(), std::mt19937(7));

  Tile tile;
  tile.mesh.offsets.resize(3 * vertices);
  tile.mesh.normals.resize(3 * vertices);
  tile.mesh.gridIndices.resize(vertices);
  for (std::size_t grid = 0; grid < vertices; ++grid) {
    const glm::dvec3 up = glm::normalize(latticePosition(points[grid], exponent));
    for (int k = 0; k < 3; ++k) {
      const auto at = 3 * place[grid] + static_cast<std::size_t>(k);
      tile.mesh.offsets[at] = static_cast<std::uint16_t>(points[grid][k] - lowest[k]);
      tile.mesh.normals[at] = static_cast<float>(up[k]);
    }
    tile.mesh.gridIndices[place[grid]] = static_cast<std::uint16_t>(grid);
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const auto vertex = [&](int di, int dj) {
        return static_cast<std::uint32_t>(place[static_cast<std::size_t>((j + dj) * row + i + di)]);
      };
      const std::uint32_t a = vertex(0, 0), b = vertex(1, 0), c = vertex(0, 1), d = vertex(1, 1);
      const bool falling = options.alternateDiagonals && (i + j) % 2;
      for (const std::uint32_t index : falling ? std::array{a, b, c, b, d, c} : std::array{a, b, d, a, d, c}) {
        tile.mesh.triangles.push_back(index);
      }
    }
  }

  TileMetadata& metadata = tile.metadata;
  metadata.path = path;
  metadata.stepExponent = exponent;
  metadata.origin = lowest;
  metadata.heights = metadata.subtreeHeights = {-100, 100};
  metadata.geometricErrorMeters = nominalTileWidthMeters(options.radiusMeters, path.level()) / 100;
  const double occluder = lowestSurfaceRadiusMeters(options.radiusMeters, -100, cells);
  const TileBounds bounds = tileBounds(path, options.radiusMeters, metadata.heights, occluder);
  metadata.sphere = bounds.sphere;
  metadata.horizonPoint = bounds.horizonPoint;
  metadata.cellsPerEdge = cells;
  return tile;
}

const std::string& smallTileBytes(const FacePath& path) {
  static std::mutex mutex;
  static std::map<FacePath, std::string> made;
  const std::lock_guard lock(mutex);
  std::string& bytes = made[path];
  if (bytes.empty()) {
    const auto encoded = encodeTile(smallTile(path, [](const glm::dvec3&) { return 0.0; }), {});
    if (!encoded) throw std::runtime_error("cannot encode " + path.text() + ": " + encoded.error().text());
    bytes.assign(encoded->begin(), encoded->end());
  }
  return bytes;
}

SceneInfo smallScene(const std::string& revision) {
  BodyInfo body;
  body.name = "moon";
  body.revision = revision;
  body.schemes = {Scheme::Cube};
  body.cellsPerEdge = kSmallCells;
  body.selection.radiusMeters = kMoonRadius;
  body.selection.maxLevel = 20;
  body.selection.heights = {-100, 100};
  body.selection.occluderRadiusMeters = lowestSurfaceRadiusMeters(kMoonRadius, -100, kSmallCells);
  for (int level = 0; level <= 20; ++level) {
    body.selection.geometricErrorMeters.push_back(nominalTileWidthMeters(kMoonRadius, level) / 100);
  }
  SceneInfo scene;
  scene.name = "small";
  scene.summary = "a body of small tiles";
  scene.bodies = {body};
  BodyInfo second = body;
  second.name = "second";
  scene.bodies.push_back(second);
  return scene;
}

}  // namespace terrane::testing

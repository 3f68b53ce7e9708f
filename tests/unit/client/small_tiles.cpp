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
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_bounds.h"
#include "common/tiling/tile_grid.h"

namespace terrane::testing {

namespace {

glm::dvec3 gridDirection(const FacePath& path, int cells, const GridVertex& at) {
  const int gridLevel = path.level() + std::countr_zero(static_cast<unsigned>(cells));
  if (path.scheme() == Scheme::Ico)
    return icoGridDirection(kIcoMap, path.face(), gridLevel, gridVertexWeights(triangleTile(path), cells, at));
  const auto along = [cells](std::uint32_t tile, int k) {
    return std::uint64_t{tile} * static_cast<std::uint64_t>(cells) + static_cast<std::uint64_t>(k);
  };
  return cubeGridDirection(path.face(), gridLevel, along(path.column(), at.i), along(path.row(), at.j));
}

}  // namespace

Tile smallTile(const FacePath& path, const HeightFormula& height, const SmallTileOptions& options) {
  const TileGrid grid{path.scheme(), options.cells};
  const auto vertices = static_cast<std::size_t>(grid.vertexCount());
  const int exponent = stepExponent(options.radiusMeters, path.level(), path.scheme());

  std::vector<LatticePoint> points;
  LatticePoint lowest(std::numeric_limits<std::int64_t>::max());
  for (int j = 0; j <= grid.cells; ++j) {
    for (int i = 0; i <= grid.rowEnd(j); ++i) {
      const glm::dvec3 direction = gridDirection(path, grid.cells, {i, j});
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
  for (std::size_t at = 0; at < vertices; ++at) {
    const glm::dvec3 up = glm::normalize(latticePosition(points[at], exponent));
    for (int k = 0; k < 3; ++k) {
      const auto component = 3 * place[at] + static_cast<std::size_t>(k);
      tile.mesh.offsets[component] = static_cast<std::uint16_t>(points[at][k] - lowest[k]);
      tile.mesh.normals[component] = static_cast<float>(up[k]);
    }
    tile.mesh.gridIndices[place[at]] = static_cast<std::uint16_t>(at);
  }
  const auto vertex = [&](const GridVertex& at) {
    return static_cast<std::uint32_t>(place[static_cast<std::size_t>(grid.index(at))]);
  };
  const auto add = [&](const GridVertex& a, const GridVertex& b, const GridVertex& c) {
    for (const GridVertex& corner : {a, b, c}) tile.mesh.triangles.push_back(vertex(corner));
  };
  for (int j = 0; j < grid.cells; ++j) {
    for (int i = 0; i < grid.rowEnd(j); ++i) {
      if (grid.isSquare() && options.alternateDiagonals && (i + j) % 2 != 0) {
        add({i, j}, {i + 1, j}, {i, j + 1});
        add({i + 1, j}, {i + 1, j + 1}, {i, j + 1});
      } else {
        grid.eachTriangle(i, j, add);
      }
    }
  }

  TileMetadata& metadata = tile.metadata;
  metadata.path = path;
  metadata.stepExponent = exponent;
  metadata.origin = lowest;
  metadata.heights = metadata.subtreeHeights = {-100, 100};
  metadata.geometricErrorMeters = nominalTileWidthMeters(options.radiusMeters, path.level(), path.scheme()) / 100;
  const double occluder = lowestSurfaceRadiusMeters(options.radiusMeters, -100, grid.cells, path.scheme());
  const TileBounds bounds = tileBounds(path, options.radiusMeters, metadata.heights, occluder);
  metadata.sphere = bounds.sphere;
  metadata.horizonPoint = bounds.horizonPoint;
  metadata.cellsPerEdge = grid.cells;
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

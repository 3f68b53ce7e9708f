#pragma once
// Tiles small enough to make by the hundred: a few cells, heights from a formula, on the lattice as real ones are; and
// a scene of one body of them.

#include <functional>
#include <string>

#include "proto/gltf_tile.h"
#include "proto/scene_json.h"
#include "proto/tile_mesh.h"

namespace terrane::testing {

inline constexpr double kMoonRadius = 1'737'400.0;
inline constexpr int kSmallCells = 4;
inline const std::string kRevision = "0123456789abcdef", kNextRevision = "fedcba9876543210";

using HeightFormula = std::function<double(const glm::dvec3& direction)>;

struct SmallTileOptions {
  double radiusMeters = kMoonRadius;
  int cells = kSmallCells;
  bool alternateDiagonals = false;  ///< as on a chess board; otherwise all join corners 00 and 11
  bool shuffleVertices = false;     ///< in another order than the grid's, as a mesh codec leaves them
};

Tile smallTile(const FacePath& path, const HeightFormula& height, const SmallTileOptions& options = {});

/// The bytes of smallTile(path, 0) on the wire; made once for each path.
const std::string& smallTileBytes(const FacePath& path);

SceneInfo smallScene(const std::string& revision = kRevision);

}  // namespace terrane::testing

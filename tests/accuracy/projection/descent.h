#pragma once
// What one flight down to the ground takes of the Moon's tiles in either scheme: the same ground, the same cameras, the
// same screen-space error. Throws std::runtime_error where a scene or tile cannot be had. Not thread-safe.

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/tiling/lattice.h"
#include "common/view/tile_selection.h"
#include "proto/draco_template.h"
#include "server/build/tile_builder.h"

namespace terrane::accuracy {

struct Place {
  std::string name;
  glm::dvec3 direction{0.0};  ///< unit, body frame
};
/// Where a map is at its best or worst: middle of a cube's face (of an edge of the icosahedron), of a cube's edge, a
/// corner of the cube (middle of a face of the icosahedron), a vertex of the icosahedron; and so many at random.
std::vector<Place> descentPlaces(std::uint64_t seed, int atRandom);

/// Cameras from 2 m above the ground up to far orbit. Each is 2^1.618 times as high as the one before, so that no level
/// of either scheme has its tiles always at their best or worst distance.
std::vector<Camera> descentCameras(const Place& place, const HeightField& moon, double radiusMeters, std::size_t count,
                                   int widthPixels, int heightPixels);
inline constexpr std::size_t kDescentCameras = 14;
inline constexpr double kLowestMeters = 2;
/// The ground that tiles are compared with has all wavelengths down to here.
inline constexpr double kFinestWavelengthMeters = 1e-3;

/// Of distinct tiles, skirts included.
struct Amounts {
  std::int64_t tiles = 0, vertices = 0, triangles = 0;
  std::int64_t bytes = 0;       ///< of GLB
  std::int64_t dracoBytes = 0;  ///< of it the mesh

  Amounts& operator+=(const Amounts& other);
};

/// A tile as it was built, before it was encoded.
struct MeshedTile {
  int stepExponent = 0;
  LatticePoint origin{0};
  std::vector<std::uint16_t> offsets;  ///< 3 a vertex, in the order of grid indices
  ResidentTile resident;
  Amounts amounts;
};

/// Where the ray from the body's centre meets a tile's mesh, metres from the centre. Error: some lattice steps of
/// double arithmetic. Preconditions: the direction is a unit vector on the tile; its level + log2(cells) <=
/// FacePath::kMaxLevel.
double meshRadiusMeters(const FacePath& path, const MeshedTile& tile, int cellsPerEdge, const glm::dvec3& direction);

/// The tile of a level that holds a direction, in either scheme. Precondition: level <= FacePath::kMaxLevel.
FacePath tileAt(Scheme scheme, const glm::dvec3& direction, int level);

/// The tiles of a shipped scene's first body, built on demand and kept.
class DescentTiles {
 public:
  explicit DescentTiles(const std::string& sceneName);

  const TileBuilder& builder() const { return builder_; }
  Scheme scheme() const { return builder_.info().selection.scheme; }
  /// The finished view of a camera: builds what is wanted until nothing is.
  TileSelection settle(const Camera& camera, double errorPixels);
  const MeshedTile& tile(const FacePath& path);
  void forget() { tiles_.clear(); }

 private:
  TileBuilder builder_;
  std::shared_ptr<const DracoTemplate> draco_;
  std::unordered_map<FacePath, MeshedTile> tiles_;
};

}  // namespace terrane::accuracy

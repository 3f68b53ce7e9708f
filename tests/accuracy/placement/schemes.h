#pragma once
// The schemes for placing a vertex, each with what it stores and what the CPU does for a vertex: the functions of
// common/numerics that shaders share.

#include <functional>
#include <glm/ext/vector_uint4_sized.hpp>
#include <string_view>
#include <vector>

#include "common/numerics/tiled_position.h"
#include "tests/accuracy/placement/sample.h"
#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {

/// A sample's vertices in a scheme's own form, with its camera.
struct Placed {
  std::function<glm::vec3(std::size_t)> at;  ///< relative to the camera, metres
  Work work;
};

struct Scheme {
  std::string_view name;
  int bytesPerVertex;          ///< stored, for a vertex
  int uploadedBytesPerVertex;  ///< for every frame in which the camera moves
  std::function<Placed(const Sample&)> onCpu;
};

const std::vector<Scheme>& schemes();

/// The worst misplacement by any of the place's cameras.
double worstMetersAt(const Scheme& scheme, double metersFromOrigin, std::uint64_t seed);

/// Names that experiments look for.
inline constexpr std::string_view kFloat32 = "float32", kCameraRelative = "camera-relative, by the CPU",
                                  kTiles = "tiles of 2048 m + offset", kTilesByHalves = "the same, by halves",
                                  kSplit = "65536 split (Cesium)", kWords = "double-float, 3 operations",
                                  kDemoted = "double-float, 18 operations", kPairs = "double-float, 20 operations",
                                  kLattice = "lattice integers (Terrane)",
                                  kLatticePairs = "lattice as double-float (Terrane)", kFloat64 = "float64";

inline constexpr float kTileMeters = 2048;
TiledPosition tiledOf(const FinePoint& point);

/// A sample's vertices in steps from an origin of their own, the lowest on each axis: as a tile stores them.
struct OnLattice {
  UnitPoint origin{};  ///< in lattice steps
  std::vector<glm::u16vec4> offsets;
  glm::ivec3 originMinusCamera{0};
  glm::vec3 cameraRest{0.0f};
};
OnLattice latticeOf(const Sample& sample);

}  // namespace terrane::accuracy

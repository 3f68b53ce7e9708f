#pragma once
// The grains of one drawn tile, as the GPU takes them: with their roots on the triangles that are drawn, between the
// tile's own surface and its parent's as the tile is. A tile of level L shows the classes up to L - 2, the finest of
// which grows as the tile's morph goes from 1 to 0: fully morphed it shows exactly what its parent shows.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "client/dust/grain_field.h"
#include "client/render/tile_draw.h"

namespace terrane {

/// The finest class that a tile shows is so many levels coarser than the tile: with 2 pixels of error its grains are
/// some pixels large.
inline constexpr int kFinestClassBelow = 2;
/// Meshes of 20, 80, 320, 1280 triangles (pebble_shapes.h); a class has the next finer one every second level.
inline constexpr int kGrainMeshes = 4;
inline constexpr int grainMesh(int tileLevel, int classLevel) noexcept {
  const int finer = (tileLevel - classLevel - kFinestClassBelow) / 2;
  return finer < kGrainMeshes ? finer : kGrainMeshes - 1;
}

/// One grain as it lies in the instance buffer.
struct GrainInstance {
  std::array<float, 3> rootHigh{};  ///< body frame, metres, as a double-float with rootLow
  float radiusMeters = 0;           ///< half its width
  std::array<float, 3> rootLow{};
  float centerMeters = 0;                ///< of its middle over its root, along the normal
  std::array<std::int16_t, 4> turn{};    ///< quaternion, normalised
  std::array<std::int16_t, 3> normal{};  ///< of the ground at its root, normalised
  std::uint16_t variant = 0;
  std::array<std::uint8_t, 3> color{};      ///< of the ground at its root, as GpuVertex has it
  std::uint8_t shade = 0;                   ///< half its shade
  std::uint8_t flattening = 0, detail = 0;  ///< normalised; detail: 1 is its mesh's own shape, 0 the coarser mesh's
  std::array<std::uint8_t, 2> padding{};
};
static_assert(sizeof(GrainInstance) == 56);

/// Grains of one class, one after the other.
struct GrainRun {
  int mesh = 0;
  float largestMeters = 0;
  std::size_t first = 0, count = 0;
};

class TileGrains {
 public:
  /// Reads the tile's vertices back from the GPU, and its parent's.
  TileGrains(const GrainField& field, const TileDraw& draw);

  /// Where the tile's morph has moved them. Only of the tile, parent and coarser edges that it was made of (fits).
  void moveTo(const MorphByBorders& byBorders);
  bool fits(const TileDraw& draw) const noexcept;

  const std::vector<GrainInstance>& instances() const noexcept { return instances_; }
  const std::vector<GrainRun>& runs() const noexcept { return runs_; }
  const std::vector<glm::dvec3>& roots() const noexcept { return roots_; }

 private:
  /// What the two surfaces are at a root.
  struct Ends {
    glm::dvec3 own{0.0};
    std::array<glm::vec3, 3> way{};              ///< to the parent's, by corner of the triangle, weighted
    std::array<float, 3> weight{};               ///< of the corners
    std::array<std::uint8_t, 3> borders{};       ///< that the corners are on
    std::array<glm::vec3, 2> normal{}, color{};  ///< own, parent's
  };
  class Surface;

  std::uint64_t tile_ = 0, parent_ = 0;  ///< GpuTile::serial; 0: none
  unsigned coarserEdges_ = 0;
  int level_ = 0;
  std::vector<Grain> grains_;
  std::vector<Ends> ends_;
  std::vector<GrainInstance> instances_;
  std::vector<glm::dvec3> roots_;
  std::vector<GrainRun> runs_;
  MorphByBorders byBorders_{};
};

}  // namespace terrane

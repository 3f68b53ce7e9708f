#pragma once
// The grains of all tiles in view, gathered for one frame: kept by tile while it is drawn, forgotten with it. What they
// take is bounded by what is drawn; tiles too far for any grain to be seen are passed over before any work. No GL but
// to read a tile's vertices back, once; GL thread only.

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "client/render/tile_grains.h"
#include "common/view/camera.h"

namespace terrane {

/// Diameters in pixels between which grains grow from nothing (client/shaders/grain.glsl).
inline constexpr float kGrainUnseenPixels = 1.2f, kGrainSeenPixels = 4.0f;

class DustInstances {
 public:
  /// relative: roots are made relative to the camera here, in double, for a GPU that cannot; their low parts are then
  /// 0.
  DustInstances(const DustSettings& settings, double bodyRadiusMeters, Scheme bodyScheme, bool relative) noexcept
      : field_(settings, bodyRadiusMeters, bodyScheme), relative_(relative) {}

  void gather(const Camera& camera, std::span<const TileDraw> tiles);

  const std::vector<GrainInstance>& ofMesh(int mesh) const noexcept { return meshes_[static_cast<std::size_t>(mesh)]; }
  bool isEmpty() const noexcept {
    return std::ranges::all_of(meshes_, [](const auto& instances) { return instances.empty(); });
  }
  std::size_t tilesKept() const noexcept { return kept_.size(); }

 private:
  struct Kept {
    TileGrains grains;
    std::uint64_t frame = 0;
  };
  class View;
  void append(const View& view, const TileGrains& grains, const GrainRun& run);

  GrainField field_;
  bool relative_;
  std::uint64_t frame_ = 0;
  std::unordered_map<FacePath, Kept> kept_;
  std::array<std::vector<GrainInstance>, kGrainMeshes> meshes_;
};

}  // namespace terrane

#pragma once
// Real tiles of the scenes that ship, built on demand in this process, and the finished view of a camera: for tests and
// experiments that draw. Not thread-safe. Throws std::runtime_error where a scene or tile cannot be had.

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/scene/effects.h"
#include "common/tiling/cube_sphere.h"
#include "common/view/camera.h"
#include "common/view/tile_selection.h"
#include "server/build/tile_builder.h"

namespace terrane {

struct TestScene {
  Body body;
  std::vector<EffectCall> effects;
};
TestScene shippedScene(const std::string& name);
/// The shipped scene of the Moon on tiles of a scheme.
constexpr const char* moonScene(Scheme scheme) noexcept { return scheme == Scheme::Cube ? "moon" : "moon-ico"; }
/// The Moon's sunlight without what else is drawn over its tiles.
std::vector<EffectCall> moonSunlight();

/// The tiles of one body, built on demand and kept.
class TileSource {
 public:
  explicit TileSource(const Body& body);
  /// Of the scene's first body.
  explicit TileSource(const std::string& sceneName) : TileSource(shippedScene(sceneName).body) {}

  const TileBuilder& builder() const { return builder_; }
  const SelectionBody& selection() const { return builder_.info().selection; }
  std::shared_ptr<const Tile> tile(const FacePath& path);
  /// What a viewer's frame selects among the tiles built so far.
  TileSelection select(const Camera& camera, const SelectionSettings& settings) const;
  /// The finished view of a camera: builds what is wanted until nothing is.
  TileSelection settle(const Camera& camera, const SelectionSettings& settings);
  /// What is drawn when everything has arrived.
  std::vector<FacePath> settledTiles(const Camera& camera, double errorPixels);
  /// Terrain height under a direction, metres above the reference sphere, of the finest level.
  double groundMeters(double longitude, double latitude) const;
  /// A pose whose altitude counts from the ground.
  Camera cameraAboveGround(const ViewPose& pose, int widthPixels, int heightPixels) const;

 private:
  TileBuilder builder_;
  std::unique_ptr<const HeightField> field_;
  std::unordered_map<FacePath, ResidentTile> resident_;
  std::unordered_map<FacePath, std::shared_ptr<const Tile>> tiles_;
};

}  // namespace terrane

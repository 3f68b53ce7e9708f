#include "tests/support/tile_source.h"

#include <stdexcept>

#include "proto/resident_tile.h"
#include "server/fields/height_field.h"
#include "server/scenes/scene_file.h"
#include "tests/support/require.h"

namespace terrane {
TestScene shippedScene(const std::string& name) {
  Scene scene = require(loadScene(name));
  return {scene.bodies.front(), scene.effects};
}

std::vector<EffectCall> moonSunlight() {
  std::vector<EffectCall> effects = shippedScene("moon").effects;
  std::erase_if(effects, [](const EffectCall& call) { return call.kind != EffectKind::Sun; });
  return effects;
}

TileSource::TileSource(const Body& body)
    : builder_(body, WireSettings{}, bestSimdPath()), field_(makeHeightField(builder_.body(), bestSimdPath())) {}

std::shared_ptr<const Tile> TileSource::tile(const FacePath& path) {
  std::shared_ptr<const Tile>& slot = tiles_[path];
  if (!slot) {
    slot = std::make_shared<const Tile>(require(builder_.buildMesh(path)));
    resident_[path] = residentTile(*slot, builder_.body().radiusMeters);
  }
  return slot;
}

TileSelection TileSource::select(const Camera& camera, const SelectionSettings& settings) const {
  const ResidentLookup lookup = [this](const FacePath& path) -> const ResidentTile* {
    const auto found = resident_.find(path);
    return found == resident_.end() ? nullptr : &found->second;
  };
  return selectTiles(camera, selection(), lookup, settings);
}

TileSelection TileSource::settle(const Camera& camera, const SelectionSettings& settings) {
  for (;;) {
    TileSelection selected = select(camera, settings);
    if (selected.complete) return selected;
    const std::size_t before = resident_.size();
    for (const WantedTile& wanted : selected.wanted) tile(wanted.path);
    if (resident_.size() == before) throw std::runtime_error("selection wants nothing more and is not complete");
  }
}

std::vector<FacePath> TileSource::settledTiles(const Camera& camera, double errorPixels) {
  return settle(camera, {.errorPixels = errorPixels}).draw;
}

double TileSource::groundMeters(double longitude, double latitude) const {
  const Camera above = cameraFromPose({longitude, latitude, 0, 0, 0}, 1.0, 1.0, 1, 1);
  const SampleBatch batch{&above.positionBody.x, &above.positionBody.y, &above.positionBody.z, 1, 1};
  SurfaceSamples samples;
  const double cell =
      nominalTileWidthMeters(builder_.body().radiusMeters, selection().maxLevel) / builder_.info().cellsPerEdge;
  field_->evaluate(batch, 2 * cell, samples);
  return samples.heightMeters.front();
}

Camera TileSource::cameraAboveGround(const ViewPose& pose, int widthPixels, int heightPixels) const {
  ViewPose placed = pose;
  placed.altitudeMeters += groundMeters(pose.longitude, pose.latitude);
  return cameraFromPose(placed, builder_.body().radiusMeters, 0.9, widthPixels, heightPixels);
}

}  // namespace terrane

#pragma once
// The Moon as a viewer shows it: a few views from orbit to the ground, and frames of them. GL thread only; needs a
// current context.

#include <array>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/render/tile_renderer.h"
#include "tests/support/tile_source.h"

namespace terrane::accuracy {

/// Where the demo goes down; the sun stands low enough for relief to show.
struct MoonView {
  const char* name;
  double aboveGroundMeters;
  double pitchDegrees;
};
inline constexpr std::array<MoonView, 4> kMoonViews{
    {{"1,000 km", 1e6, -60}, {"10 km", 1e4, -25}, {"100 m", 100, -15}, {"2 m", 2, -12}}};
Camera cameraOf(const MoonView& view, const TileSource& moon, int widthPixels, int heightPixels);

/// One view, its tiles and all that draws them.
class MoonStage {
 public:
  /// Errors: as TileRenderer::create and RenderTarget::create have them.
  static Result<std::unique_ptr<MoonStage>> create(const MoonView& view, int widthPixels, int heightPixels);

  /// Builds and uploads what the finished view needs.
  TileSelection settle(const SelectionSettings& settings);
  /// What a viewer selects every frame.
  TileSelection select(const SelectionSettings& settings) const { return tiles_.select(camera_, settings); }
  /// As a viewer does it: selects and draws; returns when the picture is there.
  DrawStats frame(const SelectionSettings& settings);
  /// Of the last frame.
  Image picture() const;
  /// What a client must fetch for a selection: the tiles drawn and those above them, as they are on the wire.
  std::size_t wireBytes(const TileSelection& selection);

 private:
  MoonStage(const MoonView& view, int widthPixels, int heightPixels, RenderTarget target);
  TileSource tiles_{"moon"};
  Camera camera_;
  RenderTarget target_;
  std::unique_ptr<TileRenderer> renderer_;
  std::unordered_set<FacePath> uploaded_;
  std::unordered_map<FacePath, std::size_t> wireBytes_;
};

}  // namespace terrane::accuracy

#include "tests/accuracy/gl/moon_stage.h"

#include <epoxy/gl.h>

#include <utility>

namespace terrane::accuracy {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kLongitude = -16.4018 * kDegree, kLatitude = 21.6039 * kDegree, kHeading = 0.4;

}  // namespace

Camera cameraOf(const MoonView& view, const TileSource& moon, int widthPixels, int heightPixels) {
  return moon.cameraAboveGround({kLongitude, kLatitude, view.aboveGroundMeters, kHeading, view.pitchDegrees * kDegree},
                                widthPixels, heightPixels);
}

Result<std::unique_ptr<MoonStage>> MoonStage::create(const MoonView& view, int widthPixels, int heightPixels) {
  auto target = RenderTarget::create(widthPixels, heightPixels);
  if (!target) return target.error();
  auto renderer = TileRenderer::create(moonSunlight());
  if (!renderer) return renderer.error();
  std::unique_ptr<MoonStage> stage(new MoonStage(view, widthPixels, heightPixels, std::move(*target)));
  stage->renderer_ = std::move(*renderer);
  return stage;
}

MoonStage::MoonStage(const MoonView& view, int widthPixels, int heightPixels, RenderTarget target)
    : camera_(cameraOf(view, tiles_, widthPixels, heightPixels)), target_(std::move(target)) {}

TileSelection MoonStage::settle(const SelectionSettings& settings) {
  TileSelection selection = tiles_.settle(camera_, settings);
  for (const FacePath& path : selection.draw)
    if (uploaded_.insert(path).second) renderer_->upload(tiles_.tile(path));
  return selection;
}

DrawStats MoonStage::frame(const SelectionSettings& settings) {
  target_.bind();
  const DrawStats stats = renderer_->draw(camera_, select(settings).draw, {.skirts = true});
  glFinish();
  return stats;
}

Image MoonStage::picture() const {
  target_.bind();
  return readFramebuffer(camera_.widthPixels, camera_.heightPixels);
}

std::size_t MoonStage::wireBytes(const TileSelection& selection) {
  std::size_t sum = 0;
  for (const WantedTile& wanted : selection.wanted) {
    std::size_t& bytes = wireBytes_[wanted.path];
    if (bytes == 0) bytes = tiles_.builder().build(wanted.path).value().glb.size();
    sum += bytes;
  }
  return sum;
}

}  // namespace terrane::accuracy

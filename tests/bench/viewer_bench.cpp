// A viewer's frame (select, place, draw) beside a bare loop that draws the same triangles into the same target, in
// turn, in one run, at three views of the Moon. Usage: bench_viewer [--frames N] [--default-heap]; prints a Markdown
// table of medians.

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>
#include <string_view>
#include <unordered_map>

#include "client/gl/render_target.h"
#include "client/gl/window.h"
#include "client/render/tile_renderer.h"
#include "common/memory/heap_policy.h"
#include "common/tiling/cube_sphere.h"
#include "common/view/tile_selection.h"
#include "proto/gltf_tile.h"
#include "proto/resident_tile.h"
#include "server/build/tile_builder.h"
#include "server/scenes/scene_file.h"
#include "tests/bench/bare_loop.h"

namespace {

using namespace terrane;
using Tiles = std::unordered_map<FacePath, std::shared_ptr<const Tile>>;

constexpr int kWidth = 1280, kHeight = 720;
constexpr double kDegrees = 0.017453292519943295;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double timeMs(const std::function<void()>& frame) {
  glFinish();
  const auto start = std::chrono::steady_clock::now();
  frame();
  glFinish();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Ground height at a place, from the finest level that matters to a view 2 m above it.
double groundHeightMeters(const Body& body, const glm::dvec3& direction) {
  const auto field = makeHeightField(body, bestSimdPath());
  SurfaceSamples samples;
  field->evaluate({&direction.x, &direction.y, &direction.z, 1, 1}, 0.005, samples);
  return samples.heightMeters[0];
}

TileSelection settle(const TileBuilder& builder, const Camera& camera, Tiles& tiles,
                     std::unordered_map<FacePath, ResidentTile>& resident) {
  const auto lookup = [&](const FacePath& path) -> const ResidentTile* {
    const auto found = resident.find(path);
    return found == resident.end() ? nullptr : &found->second;
  };
  for (;;) {
    auto selection = selectTiles(camera, builder.info().selection, lookup, {});
    if (selection.complete) return selection;
    bool added = false;
    for (const WantedTile& wanted : selection.wanted) {
      if (resident.contains(wanted.path)) continue;
      auto tile = decodeTile(builder.build(wanted.path).value().glb);
      resident[wanted.path] = residentTile(tile.value(), builder.body().radiusMeters);
      tiles[wanted.path] = std::make_shared<const Tile>(std::move(tile.value()));
      added = true;
    }
    if (!added) return selection;
  }
}

void measureView(const char* name, const ViewPose& pose, const TileBuilder& builder, TileRenderer& renderer,
                 int frames) {
  const Camera camera = cameraFromPose(pose, builder.body().radiusMeters, 60 * kDegrees, kWidth, kHeight);
  Tiles tiles;
  std::unordered_map<FacePath, ResidentTile> resident;
  const TileSelection selection = settle(builder, camera, tiles, resident);
  std::vector<std::shared_ptr<const Tile>> drawn;
  renderer.clear();
  for (const FacePath& path : selection.draw) {
    renderer.upload(tiles.at(path));
    drawn.push_back(tiles.at(path));
  }
  // Nearest first, as the renderer draws them: what is hidden behind is then not shaded by either.
  std::ranges::stable_sort(drawn, {}, [&](const auto& tile) {
    const Sphere& sphere = tile->metadata.sphere;
    return glm::length(sphere.center - camera.positionBody) - sphere.radiusMeters;
  });
  const bench::BareLoop bare(camera, drawn);
  const auto lookup = [&](const FacePath& path) -> const ResidentTile* {
    const auto found = resident.find(path);
    return found == resident.end() ? nullptr : &found->second;
  };
  std::size_t triangles = 0;
  const auto viewerFrame = [&] {
    const auto chosen = selectTiles(camera, builder.info().selection, lookup, {});
    triangles = renderer.draw(camera, chosen.draw, {.skirts = true}).triangles;
  };
  const auto bareFrame = [&] { bare.draw(); };
  for (int i = 0; i < 3; ++i) {
    timeMs(viewerFrame);
    timeMs(bareFrame);
  }
  std::vector<double> viewer, bareTimes, ratios, select;
  for (int i = 0; i < frames; ++i) {
    viewer.push_back(timeMs(viewerFrame));
    bareTimes.push_back(timeMs(bareFrame));
    ratios.push_back(viewer.back() / bareTimes.back());
    select.push_back(timeMs([&] { selectTiles(camera, builder.info().selection, lookup, {}); }));
  }
  fmt::print("| {} | {} | {} | {:.1f} | {:.2f} | {:.1f} | {:.2f} |\n", name, drawn.size(), triangles, median(viewer),
             median(select), median(bareTimes), median(ratios));
}

}  // namespace

int main(int argc, char** argv) {
  int frames = 60;
  bool defaultHeap = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view flag = argv[i];
    if (flag == "--default-heap") defaultHeap = true;
    if (flag == "--frames" && i + 1 < argc) frames = std::max(3, std::atoi(argv[++i]));
  }
  if (!defaultHeap) keepFreedMemory(kHeapKeptByViewer);
  const auto scene = loadScene("moon");
  const auto window = Window::open({kWidth, kHeight, "bench", true});
  if (!scene || !window) {
    fmt::print(stderr, "bench_viewer: {}\n", !scene ? scene.error().text() : window.error().text());
    return 2;
  }
  // What the bare loop has: tiles in sunlight. bench_effects measures what else is drawn over them.
  std::vector<EffectCall> sunlight = scene->effects;
  std::erase_if(sunlight, [](const EffectCall& call) { return call.kind != EffectKind::Sun; });
  const auto renderer = TileRenderer::create(sunlight);
  const auto target = RenderTarget::create(kWidth, kHeight);
  if (!renderer || !target) {
    fmt::print(stderr, "bench_viewer: {}\n", !renderer ? renderer.error().text() : target.error().text());
    return 2;
  }
  // Both loops draw here: the window's own depth buffer is too coarse for either, and the renderer would copy to it.
  target->bind();
  const TileBuilder builder(scene->bodies.front(), {}, bestSimdPath());
  const double longitude = -20 * kDegrees, latitude = 10 * kDegrees;
  const Camera above = cameraFromPose({longitude, latitude, 1, 0, 0}, builder.body().radiusMeters, 1, kWidth, kHeight);
  const double ground = groundHeightMeters(builder.body(), above.positionBody / builder.body().radiusMeters);

  fmt::print(
      "| view | tiles | triangles | frame ms | of it selection ms | bare loop ms | frame / bare "
      "|\n|---|---|---|---|---|---|---|\n");
  measureView("orbit, 1,000 km", {longitude, latitude, 1.0e6, 0, -60 * kDegrees}, builder, **renderer, frames);
  measureView("1 km above ground", {longitude, latitude, ground + 1000, 0, -20 * kDegrees}, builder, **renderer,
              frames);
  measureView("2 m above ground", {longitude, latitude, ground + 2, 0, -15 * kDegrees}, builder, **renderer, frames);
  fmt::print("\nMedians of {} frames in turn with the bare loop; ratio pair by pair; {}.\n", frames,
             (*renderer)->selfTest().renderer);
  return 0;
}

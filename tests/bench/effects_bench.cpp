// What each thing costs that makes the ground seamless and real: morphing tiles, the effects detail and dust, several
// samples a pixel. Frames of the Moon with all of it, and with one of it left out or put in, turn about in one run.
// Usage: bench_effects [--frames N]; prints a Markdown table of medians.

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "client/gl/window.h"
#include "client/render/tile_renderer.h"
#include "common/memory/heap_policy.h"
#include "tests/support/require.h"
#include "tests/support/tile_source.h"

namespace {

using namespace terrane;

constexpr int kWidth = 1280, kHeight = 720;
constexpr double kDegrees = 0.017453292519943295;

struct Variant {
  const char* name;
  std::vector<EffectKind> leftOut;
  bool morphs;
  int samples;
};
const std::array<Variant, 6> kVariants{{{"everything", {}, true, 1},
                                        {"no tile morphs", {}, false, 1},
                                        {"without detail", {EffectKind::Detail}, true, 1},
                                        {"without dust", {EffectKind::Dust}, true, 1},
                                        {"without all three", {EffectKind::Detail, EffectKind::Dust}, false, 1},
                                        {"4 samples a pixel", {}, true, 4}}};

struct View {
  const char* name;
  double heightMeters, pitchDegrees;
};
constexpr std::array<View, 5> kViews{{{"orbit, 1,000 km", 1e6, -60},
                                      {"1 km above ground", 1000, -20},
                                      {"2 m above ground", 2, -15},
                                      {"0.5 m above ground", 0.5, -15},
                                      {"0.2 m above ground", 0.2, -15}}};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// A view's tiles, each half way to its parent: the most that morphing can cost.
std::vector<DrawnTile> drawnTiles(const std::vector<FacePath>& paths, bool morphs) {
  std::vector<DrawnTile> tiles;
  for (const FacePath& path : paths) {
    DrawnTile tile{path, {}};
    if (morphs && path.level() > 0) {
      tile.morph.own = 0.5f;
      tile.morph.sides.fill(0.5f);
    }
    tiles.push_back(tile);
  }
  return tiles;
}

class ViewBench {
 public:
  ViewBench(TileSource& moon, const View& view)
      : camera_(moon.cameraAboveGround(
            {-16.4018 * kDegrees, 21.6039 * kDegrees, view.heightMeters, 0.4, view.pitchDegrees * kDegrees}, kWidth,
            kHeight)),
        paths_(moon.settledTiles(camera_, 2)) {
    for (const Variant& variant : kVariants) {
      std::vector<EffectCall> effects = shippedScene("moon").effects;
      std::erase_if(effects,
                    [&](const EffectCall& call) { return std::ranges::count(variant.leftOut, call.kind) > 0; });
      renderers_.push_back(require(TileRenderer::create(effects, {.bodyRadiusMeters = moon.selection().radiusMeters})));
      for (const FacePath& path : paths_) {
        renderers_.back()->upload(moon.tile(path));
        if (path.level() > 0) renderers_.back()->upload(moon.tile(path.parent()));
      }
    }
  }

  std::string row(const char* name, int frames) {
    std::array<std::vector<double>, kVariants.size()> times, ratios;
    for (int frame = -2; frame < frames; ++frame) {
      std::array<double, kVariants.size()> round{};
      for (std::size_t i = 0; i < kVariants.size(); ++i) round[i] = timeMs(i);
      if (frame < 0) continue;  // the first compile and fill
      for (std::size_t i = 0; i < kVariants.size(); ++i) {
        times[i].push_back(round[i]);
        ratios[i].push_back(round[i] / round[0]);
      }
    }
    std::string text = fmt::format("| {} | {} | {} | {:.1f}", name, paths_.size(), triangles_, median(times[0]));
    for (std::size_t i = 1; i < kVariants.size(); ++i)
      text += fmt::format(" | {:.1f} ({:.2f})", median(times[i]), median(ratios[i]));
    return text + " |\n";
  }

 private:
  double timeMs(std::size_t variant) {
    const std::vector<DrawnTile> tiles = drawnTiles(paths_, kVariants[variant].morphs);
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    const DrawStats stats = renderers_[variant]->draw(camera_, tiles, {.samples = kVariants[variant].samples});
    glFinish();
    if (variant == 0) triangles_ = stats.triangles;
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  Camera camera_;
  std::vector<FacePath> paths_;
  std::vector<std::unique_ptr<TileRenderer>> renderers_;
  std::size_t triangles_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  int frames = 15;
  for (int i = 1; i + 1 < argc; ++i)
    if (std::string_view(argv[i]) == "--frames") frames = std::max(3, std::atoi(argv[i + 1]));
  keepFreedMemory(kHeapKeptByViewer);
  const auto window = Window::open({kWidth, kHeight, "bench", true});
  if (!window) {
    fmt::print(stderr, "bench_effects: {}\n", window.error().text());
    return 2;
  }
  TileSource moon("moon");
  fmt::print("| view | tiles | triangles | {}, ms", kVariants[0].name);
  for (std::size_t i = 1; i < kVariants.size(); ++i) fmt::print(" | {}, ms (ratio)", kVariants[i].name);
  fmt::print(" |\n|---|---|---|---");
  for (std::size_t i = 1; i < kVariants.size(); ++i) fmt::print("|---");
  fmt::print("|\n");
  for (const View& view : kViews) fmt::print("{}", ViewBench(moon, view).row(view.name, frames));
  fmt::print("\nMedians of {} frames, turn about; ratios to everything, frame by frame.\n", frames);
  return 0;
}

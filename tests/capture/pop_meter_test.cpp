// What a change of the drawn set does to the picture: just before and just after it, under one camera, over a descent
// whose tiles come late. With morphs nothing that anyone sees; without, the control, everything pops.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <unordered_set>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "common/view/level_transitions.h"
#include "tests/capture/gl_fixture.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr int kLateTilesPerFrame = 3;

struct Pops {
  int changes = 0;
  double worstRms = 0, worstPerMillion = 0;  ///< of 255; pixels that differ by more than 8
  std::uint64_t uncovered = 0;
};

class PopMeter : public GlTest {
 protected:
  static Image picture(TileRenderer& renderer, const Camera& camera, const std::vector<DrawnTile>& tiles) {
    auto target = RenderTarget::create(kWidth, kHeight);
    EXPECT_TRUE(target);
    target->bind();
    renderer.draw(camera, tiles, {});
    Image image = readFramebuffer(kWidth, kHeight);
    RenderTarget::bindWindow();
    return image;
  }
  static double perMillion(const Image& a, const Image& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
      int most = 0;
      for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a.rgb[i + c] - b.rgb[i + c]));
      count += most > 8 ? 1u : 0u;
    }
    return 1e6 * static_cast<double>(count) / (static_cast<double>(kWidth) * kHeight);
  }
  static Pops fly(bool morph, int frames);
};

int frameCount() {
  const char* text = std::getenv("TERRANE_POP_FRAMES");
  return text == nullptr ? 100 : std::atoi(text);
}

Camera cameraAt(const TileSource& source, double t) {
  const ViewPose pose{-16.4 * kDegree + 0.002 * t, 21.6 * kDegree, 3e5 * std::pow(1e3 / 3e5, t), 0.4,
                      (-90 + 40 * t) * kDegree};
  return source.cameraAboveGround(pose, kWidth, kHeight);
}

Pops PopMeter::fly(bool morph, int frames) {
  TileSource source("moon");
  auto renderer = makeRenderer(shippedScene("moon").effects);
  std::unordered_set<FacePath> there;
  const auto load = [&](const FacePath& path) {
    if (there.insert(path).second) renderer->upload(source.tile(path));
  };
  for (int face = 0; face < 6; ++face) load(FacePath::wholeFace(Scheme::Cube, face));
  LevelTransitions transitions({.secondsPerLevel = 0.3, .morph = morph});
  const auto canMorph = [&](const FacePath& path) {
    return path.level() > 0 && there.contains(path) && there.contains(path.parent());
  };
  const SelectionSettings settings{.errorPixels = 2};
  Pops pops;
  std::vector<DrawnTile> drawn;
  for (int frame = 0; frame < frames; ++frame) {
    const Camera camera = cameraAt(source, frame / static_cast<double>(frames - 1));
    const TileSelection selection = source.select(camera, settings);
    const TransitionCounts before = transitions.counts();
    const std::vector<DrawnTile> changed = transitions.advance(selection.draw, 0, canMorph);
    const TransitionCounts& after = transitions.counts();
    // Tiles that enter the view were no part of the picture before: there is nothing to compare them with.
    if (frame > 0 && changed != drawn && after.entered == before.entered) {
      const Image first = picture(*renderer, camera, drawn), second = picture(*renderer, camera, changed);
      ++pops.changes;
      pops.worstRms = std::max(pops.worstRms, rmsDifference(first, second));
      pops.worstPerMillion = std::max(pops.worstPerMillion, perMillion(first, second));
    }
    drawn = transitions.advance(selection.draw, 1.0 / 30, canMorph);
    pops.uncovered += renderer->countCoverage(camera, drawn, {}, source.selection().occluderRadiusMeters).uncovered;
    int arriving = kLateTilesPerFrame;
    for (const WantedTile& wanted : selection.wanted) {
      if (there.contains(wanted.path)) continue;
      if (arriving-- == 0) break;
      load(wanted.path);
    }
  }
  return pops;
}

TEST_F(PopMeter, NoChangeOfTheDrawnSetIsSeenOverADescentWithLateTiles) {
  const Pops morphed = fly(true, frameCount()), control = fly(false, frameCount());
  for (const auto& [name, pops] : {std::pair{"morph", &morphed}, {"control, without", &control}})
    std::printf("%s: %d changes, worst RMS %.3f of 255, worst %.1f pixels per million over 8, %llu uncovered pixels\n",
                name, pops->changes, pops->worstRms, pops->worstPerMillion,
                static_cast<unsigned long long>(pops->uncovered));
  EXPECT_GE(morphed.changes, 8);
  EXPECT_LE(morphed.worstRms, 1.0);
  EXPECT_LE(morphed.worstPerMillion, 10.0);
  EXPECT_EQ(morphed.uncovered, 0u);
  EXPECT_GT(control.worstPerMillion, 1000.0);
}

}  // namespace
}  // namespace terrane

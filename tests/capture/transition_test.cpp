// The other ways of showing a change of level, which are there to be compared with: blend mixes the pictures of both
// levels, none draws tiles as they are.

#include "client/render/transition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/stitched_tiles.h"
#include "tests/support/require.h"

namespace terrane {
namespace {

constexpr int kWidth = 320, kHeight = 180;
constexpr unsigned kSeed = 20260807;

class TransitionTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    resetConstructionCounts();
    renderer_ = makeRenderer(moonSunlight());
    camera_ = moon().cameraAboveGround({-16.4 * kDegree, 21.6 * kDegree, 400, 0.4, -35 * kDegree}, kWidth, kHeight);
    paths_ = moon().settledTiles(camera_, 4);
    for (const FacePath& path : paths_) {
      renderer_->upload(moon().tile(path));
      if (path.level() > 0) renderer_->upload(moon().tile(path.parent()));
    }
  }
  /// Every tile of the view so far on its way to its parent, borders too.
  std::vector<DrawnTile> onTheirWay(float morph) const {
    std::vector<DrawnTile> tiles;
    for (const FacePath& path : paths_) tiles.push_back({path, morphedBy(morph)});
    return tiles;
  }
  Image picture(const std::vector<DrawnTile>& tiles, Transition transition, int samples = 1) {
    const auto target = require(RenderTarget::create(kWidth, kHeight, TargetFormat::Rgba8, samples));
    target.bind();
    renderer_->draw(camera_, tiles, {.skirts = true, .transition = transition});
    target.bindForReading();
    Image image = readFramebuffer(kWidth, kHeight);
    RenderTarget::bindWindow();
    return image;
  }
  static int blendsConstructed() {
    for (const auto& [name, count] : constructionCounts())
      if (name == "transition.blend") return count;
    return 0;
  }

  std::unique_ptr<TileRenderer> renderer_;
  Camera camera_;
  std::vector<FacePath> paths_;
};

TEST_F(TransitionTest, WhereNothingIsInBetweenAllGiveTheSamePicture) {
  const Image morph = picture(onTheirWay(0), Transition::Morph);
  EXPECT_EQ(picture(onTheirWay(0), Transition::Blend).rgb, morph.rgb);
  EXPECT_EQ(picture(onTheirWay(0), Transition::None).rgb, morph.rgb);
  EXPECT_NE(picture(onTheirWay(0.5f), Transition::Morph).rgb, morph.rgb) << "the control";
  EXPECT_EQ(picture(onTheirWay(0.5f), Transition::None).rgb, morph.rgb) << "tiles as they are, whatever they morph";
}

TEST_F(TransitionTest, HalfWayBlendIsTheMeanOfBothLevelsPictures) {
  for (const int samples : {1, 4}) {
    const Image own = picture(onTheirWay(0), Transition::Morph, samples),
                parents = picture(onTheirWay(1), Transition::Morph, samples),
                blend = picture(onTheirWay(0.5f), Transition::Blend, samples);
    double worst = 0;
    for (std::size_t i = 0; i < blend.rgb.size(); ++i)
      worst = std::max(worst, std::abs(blend.rgb[i] - 0.5 * (own.rgb[i] + parents.rgb[i])));
    std::printf("%d samples: RMS between the levels %.2f of 255, blend off their mean by at most %.1f\n", samples,
                rmsDifference(own, parents), worst);
    EXPECT_GT(rmsDifference(own, parents), 2.0) << "there is something to blend";
    // Alpha is 128/255: half a step at most; and colours are rounded twice.
    EXPECT_LE(worst, 1.5);
  }
}

TEST_F(TransitionTest, WhatBlendNeedsIsMadeOnlyWhereTilesAreBlended) {
  picture(onTheirWay(0.5f), Transition::Morph);
  picture(onTheirWay(0.5f), Transition::None);
  picture(onTheirWay(0), Transition::Blend);
  EXPECT_EQ(blendsConstructed(), 0);
  picture(onTheirWay(0.5f), Transition::Blend);
  picture(onTheirWay(0.7f), Transition::Blend);
  EXPECT_EQ(blendsConstructed(), 1);
}

TEST_F(TransitionTest, TheSurfaceIsClosedByItsSkirtsWhereNothingIsStitched) {
  const std::vector<DrawnTile> tiles = tilesOnTheirWay(paths_, kSeed);
  for (const Transition transition : {Transition::Blend, Transition::None}) {
    const CoverageCount count =
        renderer_->countCoverage(camera_, tiles, {.transition = transition}, moon().selection().occluderRadiusMeters);
    EXPECT_EQ(count.uncovered, 0u) << transitionName(transition);
    EXPECT_GT(count.skirt, 0u) << transitionName(transition);
  }
}

TEST(Transition, UnknownNamesListWhatIsAllowed) {
  const auto wrong = parseTransition("fade");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().field, "--transition");
  for (const char* name : {"morph", "blend", "none"}) EXPECT_NE(wrong.error().message.find(name), std::string::npos);
}

}  // namespace
}  // namespace terrane

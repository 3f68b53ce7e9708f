// The ground's texture without end: it does not shimmer, it changes scale without a step, and it is as good as gone
// where it is averaged.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/render/detail_pass.h"
#include "tests/capture/gl_fixture.h"
#include "tests/support/require.h"

namespace terrane {
namespace {

constexpr int kWidth = 320, kHeight = 180;

DetailStrength evenStrength(float finestPixels) {
  DetailStrength strength;
  strength.slopes.fill(0.15f);
  strength.mottles.fill(0.05f);
  strength.finestPixels = finestPixels;
  return strength;
}

class Detail : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    renderer_ = makeRenderer(moonSunlight());
    effects_ = makeEffects(moonSunlight());
  }

  static Camera cameraAt(double heightMeters, double pitchDegrees, int scale) {
    const ViewPose pose{-16.4018 * kDegree, 21.6039 * kDegree, heightMeters, 0.4, pitchDegrees * kDegree};
    return moon().cameraAboveGround(pose, scale * kWidth, scale * kHeight);
  }

  const std::vector<FacePath>& settle(const Camera& camera) {
    tiles_ = moon().settledTiles(camera, 2);
    for (const FacePath& path : tiles_) renderer_->upload(moon().tile(path));
    return tiles_;
  }

  /// The settled tiles under this camera, with detail or without.
  Image picture(const Camera& camera, EffectPass* detail, int samples = 1) {
    auto target = require(RenderTarget::create(camera.widthPixels, camera.heightPixels, TargetFormat::Rgba8, samples));
    target.bind();
    renderer_->draw(camera, tiles_, {});
    if (detail != nullptr) detail->draw(camera, {}, {});
    target.bindForReading();
    Image image = readFramebuffer(camera.widthPixels, camera.heightPixels);
    RenderTarget::bindWindow();
    return image;
  }

  std::unique_ptr<EffectPass> pass(float finestPixels) {
    static const gl::Capabilities capabilities = gl::detectCapabilities();
    return require(makeDetailPass(evenStrength(finestPixels), {capabilities, renderer_->selfTest(), effects_}));
  }

  std::unique_ptr<TileRenderer> renderer_;
  EffectList effects_;
  std::vector<FacePath> tiles_;
};

/// Means of blocks of scale x scale pixels.
Image averaged(const Image& fine, int scale) {
  Image image{fine.width / scale, fine.height / scale, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(image.width * image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        int sum = 0;
        for (int j = 0; j < scale; ++j)
          for (int i = 0; i < scale; ++i)
            sum += fine.rgb[static_cast<std::size_t>(3 * ((y * scale + j) * fine.width + x * scale + i) + channel)];
        image.rgb[static_cast<std::size_t>(3 * (y * image.width + x) + channel)] =
            static_cast<std::uint8_t>(std::lround(static_cast<double>(sum) / (scale * scale)));
      }
  return image;
}

TEST_F(Detail, AGrazingViewHoldsNoWavesThatItsPixelsCannotShow) {
  // What 16 samples a pixel average to is what a pixel should show. Waves that pixels undersample differ from it, by
  // another amount in every frame: that is what shimmers.
  constexpr int kScale = 4;
  const Camera camera = cameraAt(2, -3, 1), fineCamera = cameraAt(2, -3, kScale);
  settle(camera);
  const auto offAverage = [&](EffectPass* coarse, EffectPass* fine) {
    return rmsDifference(picture(camera, coarse), averaged(picture(fineCamera, fine), kScale));
  };
  const auto shipped = pass(2.5f), atFinerPixels = pass(2.5f * kScale), unfiltered = pass(0.1f),
             unfilteredFiner = pass(0.1f * kScale);
  const double bare = offAverage(nullptr, nullptr);
  const double detail = offAverage(shipped.get(), atFinerPixels.get());
  const double control = offAverage(unfiltered.get(), unfilteredFiner.get());
  std::printf(
      "off the average of 16 samples, RMS of 255: %.2f without detail, %.2f with, %.2f where waves below a pixel are "
      "shown\n",
      bare, detail, control);
  EXPECT_LT(detail, bare + 0.7);
  EXPECT_GT(control, bare + 3);
}

TEST_F(Detail, WavesComeAndGoWithTheScaleWithoutAStep) {
  // A zoom through two octaves in steps of a sixty-fourth: pictures differ from step to step by the zoom alone, evenly.
  Camera camera = cameraAt(2, -60, 1);
  settle(camera);
  const auto detail = pass(2.5f);
  std::vector<double> steps;
  Image before;
  for (int step = 0; step <= 128; ++step) {
    camera.verticalFieldOfView = 0.8 * std::exp2(-step / 64.0);
    Image now = picture(camera, detail.get());
    if (step > 0) steps.push_back(rmsDifference(before, now));
    before = std::move(now);
  }
  std::vector<double> sorted = steps;
  std::ranges::sort(sorted);
  const double median = sorted[sorted.size() / 2];
  std::printf("from step to step, RMS of 255: median %.2f, worst %.2f\n", median, sorted.back());
  EXPECT_GT(median, 0);
  EXPECT_LT(sorted.back(), 1.3 * median);
}

TEST_F(Detail, ItShowsAtEveryScaleAndLeavesTheMeanAsItIs) {
  const auto detail = pass(2.5f);
  for (const double height : {0.2, 2.0, 100.0, 1e4, 1e6}) {
    const Camera camera = cameraAt(height, -60, 1);
    settle(camera);
    const Image with = picture(camera, detail.get()), without = picture(camera, nullptr);
    double sumWith = 0, sumWithout = 0;
    for (std::size_t i = 0; i < with.rgb.size(); ++i) {
      sumWith += with.rgb[i];
      sumWithout += without.rgb[i];
    }
    const double change = rmsDifference(with, without), mean = sumWith / sumWithout;
    std::printf("%g m: changes the picture by %.2f of 255 (RMS), its mean by a factor of %.4f\n", height, change, mean);
    EXPECT_GT(change, 1.0) << height << " m";
    EXPECT_NEAR(mean, 1.0, 0.05) << height << " m";
  }
}

TEST_F(Detail, WithSeveralSamplesAPixelItIsTheSameTexture) {
  const Camera camera = cameraAt(2, -30, 1);
  settle(camera);
  const auto detail = pass(2.5f);
  const double difference = rmsDifference(picture(camera, detail.get(), 1), picture(camera, detail.get(), 4));
  std::printf("RMS %.2f of 255 between 1 and 4 samples a pixel\n", difference);
  EXPECT_LT(difference, 6);
}

}  // namespace
}  // namespace terrane

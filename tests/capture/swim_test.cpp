// The ground's texture lies still: a marked texel, followed while the camera creeps by, does not move against the
// ground.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/capture/gl_fixture.h"
#include "tests/support/require.h"
#include "tests/support/swim_meter.h"

namespace terrane {
namespace {

int frameCount() {
  const char* text = std::getenv("TERRANE_SWIM_FRAMES");
  return text == nullptr ? 30 : std::atoi(text);
}

class SwimMeter : public GlTestOfSchemes {};

TEST_P(SwimMeter, ATexelStaysWithinATwentiethOfAPixelOfItsPlaceFromHalfAMetreToOrbit) {
  for (const double height : {0.2, 0.5, 100.0, 1e5}) {
    test::SwimSettings settings{.heightMeters = height, .frames = frameCount()};
    const test::Swim swim = require(test::measureSwim(tiles(), settings));
    settings.coordinates = test::TextureCoordinates::Float32;
    settings.frames = 10;
    const test::Swim control = require(test::measureSwim(tiles(), settings));
    std::printf(
        "%g m: %d frames, %d level changes, wavelength %g m: worst %.5f, median %.5f pixels; float32 worst %.4g, "
        "median %.4g\n",
        height, swim.frames, swim.levelChanges, swim.wavelengthMeters, swim.worstPixels, swim.medianPixels,
        control.worstPixels, control.medianPixels);
    EXPECT_EQ(swim.frames, frameCount());
    EXPECT_LT(swim.worstPixels, 0.05) << height << " m";
    if (height <= 100) {
      EXPECT_GT(control.medianPixels, 0.05) << height << " m";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, SwimMeter, test::bothSchemes(), test::nameOfScheme);

}  // namespace
}  // namespace terrane

// No change of the drawn set is seen: just before and just after it the picture is the same, over flights whose tiles
// come late. Without morphs, the control, everything pops. TERRANE_POP_FRAMES: of each flight, up to 2000 (100).

#include "tests/support/pop_meter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <tuple>

#include "tests/capture/gl_fixture.h"

namespace terrane {
namespace {

constexpr int kWidth = 640, kHeight = 360;
/// Of the control, which pops at its first changes.
constexpr int kControlFrames = 100;

int frameCount() {
  const char* text = std::getenv("TERRANE_POP_FRAMES");  // NOLINT(concurrency-mt-unsafe): one thread
  return text == nullptr ? 100 : std::clamp(std::atoi(text), 2, kPopFlightFrames);
}

using SchemeAndFlight = std::tuple<Scheme, PopFlight>;

class PopTest : public GlTest, public testing::WithParamInterface<SchemeAndFlight> {
 protected:
  static Pops fly(TileSource& tiles, Transition transition, int frames) {
    const PopFlight flight = std::get<1>(GetParam());
    const Pops pops = PopMeter(tiles, flight, transition, kWidth, kHeight).fly(frames);
    std::printf(
        "%s, %s, %d frames: %d changes, RMS worst %.3f, median %.3f of 255, worst %.1f pixels per million over 8, %llu "
        "hurried, %llu jumps, %llu uncovered pixels\n",
        std::string(popFlightName(flight)).c_str(), std::string(transitionName(transition)).c_str(), pops.frames,
        pops.changes, pops.worstRms, pops.medianRms, pops.worstPerMillion,
        static_cast<unsigned long long>(pops.hurried), static_cast<unsigned long long>(pops.jumps),
        static_cast<unsigned long long>(pops.uncovered));
    std::fflush(stdout);
    return pops;
  }
};

TEST_P(PopTest, NoChangeOfTheDrawnSetIsSeenThoughTilesComeLate) {
  TileSource tiles(moonScene(std::get<0>(GetParam())));
  const Pops morphed = fly(tiles, Transition::Morph, frameCount());
  EXPECT_GE(morphed.changes, 8);
  EXPECT_LE(morphed.worstRms, 1.0);
  EXPECT_LE(morphed.worstPerMillion, 10.0);
  EXPECT_EQ(morphed.uncovered, 0u);
  EXPECT_GT(fly(tiles, Transition::None, kControlFrames).worstPerMillion, 1000.0) << "the control";
}

INSTANTIATE_TEST_SUITE_P(Flights, PopTest, testing::Combine(test::bothSchemes(), testing::ValuesIn(kPopFlights)),
                         [](const testing::TestParamInfo<SchemeAndFlight>& flight) {
                           const bool walks = std::get<1>(flight.param) == PopFlight::Walk;
                           return std::string(schemeName(std::get<0>(flight.param))) + (walks ? "_Walk" : "_Descent");
                         });

}  // namespace
}  // namespace terrane

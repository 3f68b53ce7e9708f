// What this GPU's arithmetic does, as the start-up check found it. The facts about llvmpipe are the controls: they show
// that the check sees a broken TwoSum when there is one.

#include <gtest/gtest.h>

#include "client/gl/capabilities.h"
#include "client/render/gpu_self_test.h"
#include "tests/capture/gl_fixture.h"

namespace terrane {
namespace {

class GpuSelfTest : public GlTest {};

void print(const SelfTestReport& report) {
  std::printf("%s | %s | integer %d, two_sum precise %d, plain %d, two_prod %d, fma fused %d -> %s\n",
              report.renderer.c_str(), report.version.c_str(), report.integerExact, report.twoSumExact,
              report.twoSumWithoutPrecise, report.twoProdExact, report.fmaFused,
              std::string(placementName(report.chosen)).c_str());
}

bool isLlvmpipe(const SelfTestReport& report) { return report.renderer.find("llvmpipe") != std::string::npos; }

TEST_F(GpuSelfTest, ChoosesAPlacementThatThisGpuComputesExactly) {
  const auto report = runGpuSelfTest(gl::detectCapabilities());
  ASSERT_TRUE(report) << report.error().text();
  print(*report);
  EXPECT_FALSE(report->renderer.empty());
  switch (report->chosen) {
    case Placement::Integer:
      EXPECT_TRUE(report->integerExact);
      break;
    case Placement::DoubleFloat:
      EXPECT_TRUE(report->twoSumExact);
      break;
    default:
      EXPECT_TRUE(!report->integerExact && !report->twoSumExact);
      break;
  }
}

TEST_F(GpuSelfTest, OnLlvmpipeErrorTermsSurviveOnlyWithPreciseAndFmaIsNotFused) {
  const auto report = runGpuSelfTest(gl::detectCapabilities());
  ASSERT_TRUE(report) << report.error().text();
  if (!isLlvmpipe(*report)) GTEST_SKIP() << "a statement about llvmpipe; this is " << report->renderer;
  EXPECT_TRUE(report->integerExact);
  EXPECT_TRUE(report->twoSumExact);
  EXPECT_TRUE(report->twoProdExact);
  EXPECT_FALSE(report->twoSumWithoutPrecise) << "the control: without precise the compiler deletes the error term";
  EXPECT_FALSE(report->fmaFused);
}

TEST_F(GpuSelfTest, WithoutThePreciseQualifierDoubleFloatIsRefusedWhereTheCompilerBreaksIt) {
  const auto report = runGpuSelfTest(gl::detectCapabilities(true));
  ASSERT_TRUE(report) << report.error().text();
  print(*report);
  auto renderer = TileRenderer::create({}, {.forceBaseline = true});
  ASSERT_TRUE(renderer) << renderer.error().text();
  EXPECT_EQ((*renderer)->usable(Placement::DoubleFloat), report->twoSumExact ? Placement::DoubleFloat : Placement::Cpu);
  EXPECT_EQ((*renderer)->usable(Placement::Cpu), Placement::Cpu);
  if (isLlvmpipe(*report)) {
    EXPECT_FALSE(report->twoSumExact);
    EXPECT_TRUE(report->integerExact) << "integers need no qualifier";
  }
}

TEST_F(GpuSelfTest, OnlyEffectsThatTheSceneNamesAreConstructed) {
  resetConstructionCounts();
  ASSERT_TRUE(TileRenderer::create({}));
  EXPECT_TRUE(constructionCounts().empty());
  ASSERT_TRUE(TileRenderer::create(shippedScene("moon").effects));
  const std::vector<std::pair<std::string, int>> once{{"effect.detail", 1}, {"effect.dust", 1}, {"effect.sun", 1}};
  EXPECT_EQ(constructionCounts(), once);
}

}  // namespace
}  // namespace terrane

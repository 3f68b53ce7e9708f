// Double-float on this GPU: the suite that the CPU's forms pass, run over the shaders' forms of the same source; and
// the controls that fail: TwoSum without precise, and the product's error by fma().

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <iostream>
#include <limits>

#include "client/gl/capabilities.h"
#include "client/render/gpu_self_test.h"
#include "tests/capture/gl_fixture.h"
#include "tests/support/shader_conformance.h"

namespace terrane {
namespace {

using test::exact;
using test::HighPrecision;
using test::OperandPair;
using test::PairOperation;
using test::ShaderForm;

bool sameBits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }
bool sameBits(const DoubleFloat& a, const DoubleFloat& b) { return sameBits(a.hi, b.hi) && sameBits(a.lo, b.lo); }

class DoubleFloatShader : public GlTest {};

TEST_F(DoubleFloatShader, KeepsTheProvenBoundsInScalarsAndInLanes) {
  constexpr std::uint64_t kSeed = 411;
  std::cout << "seed " << kSeed << '\n';
  for (const ShaderForm form : {ShaderForm::Scalar, ShaderForm::Lanes}) {
    const test::Evaluate evaluate = test::onShader(form);
    for (const PairOperation& operation : test::pairOperations()) {
      const double worst = test::searchWorst(operation, evaluate, kSeed, 60000).units;
      const double bound = operation.shaderBound > 0 ? operation.shaderBound : operation.bound;
      std::cout << (form == ShaderForm::Scalar ? "float " : "vec3  ") << operation.title << ": worst " << worst
                << ", bound " << bound << (operation.unit == kFloatUnit ? " u\n" : " u^2\n");
      EXPECT_LE(worst, bound) << operation.name;
      EXPECT_GE(worst, 0.7 * operation.expected) << operation.name << ": the search is too easy to prove anything";
    }
  }
}

TEST_F(DoubleFloatShader, GivesTheCpusBitsWhereverTheLanguagePromisesCorrectRounding) {
  const test::Evaluate cpu = test::bareOnCpu(), gpu = test::onShader(ShaderForm::Lanes);
  for (const PairOperation& operation : test::pairOperations()) {
    std::size_t differing = 0, count = 0;
    const test::Evaluate both = [&](const PairOperation& one, std::span<const OperandPair> operands) {
      auto results = gpu(one, operands);
      const auto expected = cpu(one, operands);
      for (std::size_t i = 0; i < results.size(); ++i) differing += sameBits(results[i], expected[i]) ? 0u : 1u;
      count += results.size();
      return results;
    };
    test::searchWorst(operation, both, 412, 12000);
    std::cout << operation.title << ": " << differing << " of " << count << " differ\n";
    // Division and roots need not be correctly rounded.
    EXPECT_TRUE(differing == 0 || operation.shaderBound > 0) << operation.name;
  }
}

bool isLlvmpipe(const SelfTestReport& report) { return report.renderer.find("llvmpipe") != std::string::npos; }

TEST_F(DoubleFloatShader, WithoutPreciseOnLlvmpipeSumsBreakTheirBounds) {
  const auto report = runGpuSelfTest(gl::detectCapabilities());
  ASSERT_TRUE(report);
  if (!isLlvmpipe(*report)) GTEST_SKIP() << "a statement about llvmpipe; this is " << report->renderer;
  const test::Evaluate unqualified = test::onShader(ShaderForm::Unqualified);
  for (const PairOperation& operation : test::pairOperations()) {
    if (operation.operands != test::OperandKind::Sum && operation.operands != test::OperandKind::Difference) continue;
    const bool demoted = operation.unit == kFloatUnit;
    const double worst = test::searchWorst(operation, unqualified, 413, 6000).units;
    std::cout << operation.title << " without precise: worst " << worst << (demoted ? " u\n" : " u^2\n");
    EXPECT_GT(worst, demoted ? 2 * operation.bound : 1e6) << operation.name;
  }
}

/// The bare transforms, which are no operation of pairs.
PairOperation transform(const char* name, const char* shader) {
  PairOperation operation;
  operation.name = name;
  operation.shader = shader;
  return operation;
}

TEST_F(DoubleFloatShader, TransformsAreExactWithPreciseAndDekkersSplitAndFailWithoutThemAndByFma) {
  const PairOperation sum = transform("twoSum", "twoSum(x.hi, y.hi)");
  const PairOperation split = transform("twoProd", "twoProd(x.hi, y.hi)");
  const PairOperation fused = transform("twoProdFma", "twoProdFma(x.hi, y.hi)");
  test::DoubleFloatOperands operands(414);
  std::vector<OperandPair> pairs;
  for (int i = 0; i < 30000; ++i) pairs.push_back({{operands.single(-20, 20), 0}, {operands.single(-20, 20), 0}});
  const auto wrong = [&](const PairOperation& operation, ShaderForm form, bool product) {
    const auto results = test::onShader(form)(operation, pairs);
    std::size_t count = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      const HighPrecision a(pairs[i].x.hi), b(pairs[i].y.hi);
      count += exact(results[i]) == (product ? HighPrecision(a * b) : HighPrecision(a + b)) ? 0u : 1u;
    }
    return count;
  };
  EXPECT_EQ(wrong(sum, ShaderForm::Scalar, false), 0u);
  EXPECT_EQ(wrong(sum, ShaderForm::Lanes, false), 0u);
  EXPECT_EQ(wrong(split, ShaderForm::Scalar, true), 0u);
  EXPECT_EQ(wrong(split, ShaderForm::Lanes, true), 0u);
  const std::size_t sumControl = wrong(sum, ShaderForm::Unqualified, false);
  const std::size_t fmaControl = wrong(fused, ShaderForm::Scalar, true);
  std::cout << "of " << pairs.size() << " wrong: TwoSum without precise " << sumControl << ", the product by fma() "
            << fmaControl << "; with precise, and by Dekker's split, 0\n";
  const auto report = runGpuSelfTest(gl::detectCapabilities());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->twoSumWithoutPrecise, sumControl == 0) << "the start-up check agrees";
  EXPECT_EQ(report->fmaFused, fmaControl == 0) << "the start-up check agrees";
  if (!isLlvmpipe(*report)) GTEST_SKIP() << "the rest is a statement about llvmpipe";
  EXPECT_GT(sumControl, pairs.size() / 2);
  EXPECT_GT(fmaControl, pairs.size() / 2);
}

TEST_F(DoubleFloatShader, NeverTurnsWhatIsNotFiniteIntoAFiniteNumber) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const test::Evaluate gpu = test::onShader(ShaderForm::Scalar);
  for (const PairOperation& operation : test::pairOperations()) {
    const std::vector<OperandPair> operands{
        {{inf, 0}, {2, 0}}, {{-inf, 0}, {2, 0}}, {{nan, 0}, {2, 0}}, {{2, 0}, {inf, 0}}, {{2, 0}, {nan, 0}}};
    const auto results = gpu(operation, operands);
    const std::size_t count = operation.operands == test::OperandKind::Positive ? 3 : operands.size();
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_FALSE(std::isfinite(results[i].hi) && std::isfinite(results[i].lo)) << operation.name << " case " << i;
  }
}

}  // namespace
}  // namespace terrane

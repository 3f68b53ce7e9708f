// The seam: what is constructed, which SIMD paths exist, what the table of fields says.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/fields/field_samples.h"

namespace terrane {
namespace {

using namespace test;

TEST(MakeHeightField, ConstructsWhatTheBodyNamesAndNothingElse) {
  resetConstructionCounts();
  Body body;
  body.radiusMeters = 1000;
  const auto sphere = makeHeightField(body, bestSimdPath());
  const auto counts = constructionCounts();
  ASSERT_EQ(counts.size(), 1u);
  EXPECT_EQ(counts.front().first, "field.sphere");
  EXPECT_EQ(counts.front().second, 1);
  resetConstructionCounts();
  const auto moon = makeHeightField(testMoon(), bestSimdPath());
  ASSERT_EQ(constructionCounts().size(), 1u);
  EXPECT_EQ(constructionCounts().front().first, "field.lunar");
  EXPECT_NE(sphere->identity(), moon->identity());
}

TEST(SphereField, IsZeroWithoutGradientOrColour) {
  Body body;
  body.radiusMeters = 1000;
  const auto sphere = makeHeightField(body, bestSimdPath());
  SurfaceSamples samples = evaluate(*makeHeightField(testMoon(), bestSimdPath()), tileGrid(0, 2, 1, 1), 1e5);
  const Directions grid = tileGrid(3, 2, 1, 1);
  sphere->evaluate(grid.batch(), 1, samples);
  ASSERT_EQ(samples.heightMeters.size(), grid.x.size());
  EXPECT_TRUE(std::all_of(samples.heightMeters.begin(), samples.heightMeters.end(), [](double h) { return h == 0; }));
  EXPECT_TRUE(std::all_of(samples.gradientZ.begin(), samples.gradientZ.end(), [](float g) { return g == 0; }));
  EXPECT_TRUE(samples.reflectance.empty());
  EXPECT_EQ(sphere->omittedAmplitudeMeters(100, 0), 0);
  EXPECT_EQ(sphere->heightRange().maxMeters, 0);
}

TEST(SimdPaths, ParseByNameAndRefuseOthers) {
  EXPECT_EQ(parseSimdPath("default").value(), SimdPath::Default);
  EXPECT_EQ(parseSimdPath("v3").value(), SimdPath::V3);
  EXPECT_EQ(parseSimdPath("v4").value(), SimdPath::V4);
  for (const char* bad : {"", "V3", "avx2", "v5", "default "}) {
    const auto result = parseSimdPath(bad);
    ASSERT_TRUE(result.has_error()) << bad;
    EXPECT_EQ(result.error().field, "--simd");
  }
  EXPECT_TRUE(simdPathSupported(SimdPath::Default));
  EXPECT_TRUE(simdPathSupported(bestSimdPath()));
}

TEST(FieldTable, EveryKindHasARowFoundByItsNameWithValidDefaults) {
  ASSERT_EQ(fieldTable().size(), static_cast<std::size_t>(kFieldKindCount));
  for (const FieldRow& row : fieldTable()) {
    EXPECT_EQ(findField(row.name), row.kind);
    EXPECT_EQ(fieldRow(row.kind).name, row.name);
    for (const ParameterSpec& spec : row.parameters) {
      EXPECT_LE(spec.minimum, spec.defaultValue) << spec.name;
      EXPECT_LE(spec.defaultValue, spec.maximum) << spec.name;
      EXPECT_FALSE(spec.summary.empty());
    }
  }
  EXPECT_FALSE(findField("mars").has_value());
  EXPECT_FALSE(findField("").has_value());
}

}  // namespace
}  // namespace terrane

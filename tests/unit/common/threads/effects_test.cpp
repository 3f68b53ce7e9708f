#include "common/scene/effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <thread>

namespace terrane {
namespace {

TEST(Effects, EveryKindHasOneRowInItsPlaceWithAUniqueNameAndAllTexts) {
  ASSERT_EQ(effectTable().size(), static_cast<std::size_t>(kEffectKindCount));
  std::set<std::string_view> names;
  for (int i = 0; i < kEffectKindCount; ++i) {
    const EffectKind kind = static_cast<EffectKind>(i);
    const EffectRow& row = effectRow(kind);
    EXPECT_EQ(row.kind, kind);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(findEffect(row.name), kind);
    EXPECT_FALSE(row.summary.empty()) << row.name;
    EXPECT_FALSE(row.needs.empty()) << row.name;
    EXPECT_FALSE(row.cost.empty()) << row.name;
  }
}

TEST(Effects, AnUnknownNameIsNoEffect) {
  EXPECT_EQ(findEffect("snu"), std::nullopt);
  EXPECT_EQ(findEffect(""), std::nullopt);
  EXPECT_EQ(findEffect("Sun"), std::nullopt);
}

TEST(Effects, EveryParameterIsDescribedAndItsDefaultIsInItsRange) {
  for (const EffectRow& row : effectTable()) {
    std::set<std::string_view> names;
    for (const ParameterSpec& spec : row.parameters) {
      EXPECT_TRUE(names.insert(spec.name).second) << row.name << "." << spec.name;
      EXPECT_FALSE(spec.summary.empty()) << row.name << "." << spec.name;
      EXPECT_LT(spec.minimum, spec.maximum) << row.name << "." << spec.name;
      EXPECT_GE(spec.defaultValue, spec.minimum) << row.name << "." << spec.name;
      EXPECT_LE(spec.defaultValue, spec.maximum) << row.name << "." << spec.name;
    }
    EXPECT_EQ(defaultValues(row.parameters).size(), row.parameters.size()) << row.name;
  }
}

TEST(Effects, DefaultValuesHoldEveryParameterOfTheSchema) {
  const ParameterValues values = defaultValues(effectRow(EffectKind::Sun).parameters);
  EXPECT_THAT(values, testing::Contains(testing::Key("longitude")));
  EXPECT_THAT(values, testing::Contains(testing::Key("latitude")));
}

TEST(Effects, ConstructionCountsFromManyThreadsAddUp) {
  resetConstructionCounts();
  EXPECT_TRUE(constructionCounts().empty());
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([] {
      for (int k = 0; k < 250; ++k) countConstruction(k % 2 ? "effect.a" : "field.b");
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(constructionCounts(),
              testing::ElementsAre(testing::Pair("effect.a", 500), testing::Pair("field.b", 500)));
  resetConstructionCounts();
}

}  // namespace
}  // namespace terrane

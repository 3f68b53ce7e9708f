#include "server/scenes/quantity_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace terrane {
namespace {

TEST(QuantityText, LengthsAreTheDoubleNearestToTheDecimalText) {
  const auto metres = [](std::string_view text) { return parseQuantity(text, Quantity::Length).value(); };
  EXPECT_EQ(metres("1737.4 km"), 1737400.0);
  EXPECT_EQ(metres("1737.4km"), 1737400.0);
  EXPECT_EQ(metres("4 mm"), 0.004);
  EXPECT_EQ(metres("0.3 mm"), 0.0003);
  EXPECT_EQ(metres("1e3 mm"), 1.0);
  EXPECT_EQ(metres("1.5E+2 m"), 150.0);
  EXPECT_EQ(metres("-2e-1 km"), -200.0);
  EXPECT_EQ(metres("0 m"), 0.0);
}

TEST(QuantityText, AnglesAreRadians) {
  EXPECT_EQ(parseQuantity("180 deg", Quantity::Angle).value(), std::numbers::pi);
  EXPECT_EQ(parseQuantity("1.25 rad", Quantity::Angle).value(), 1.25);
}

TEST(QuantityText, WhatIsNoNumberWithAUnitIsRefused) {
  for (const std::string_view text : {"",         " ",
                                      "km",       "1",
                                      "1 ",       "1 mi",
                                      "1 k m",    "1,5 km",
                                      "1_000 m",  "+1 m",
                                      ".5 m",     "1e m",
                                      "1e5000 m", "1 2 m",
                                      "nan m",    "inf m",
                                      "-inf m",   "0x1 m",
                                      "--1 m",    "1.2.3 m",
                                      "1e1e1 m",  "1e99999999999 m",
                                      "m 1",      "1 KM"}) {
    const Result<double> value = parseQuantity(text, Quantity::Length);
    ASSERT_FALSE(value) << text;
    EXPECT_THAT(value.error().message, testing::HasSubstr("mm, m, km")) << text;
  }
  EXPECT_FALSE(parseQuantity("1 deg", Quantity::Length));
  EXPECT_FALSE(parseQuantity("1 m", Quantity::Angle));
}

TEST(QuantityText, WhatIsPrintedIsReadBackAsTheSame) {
  for (const double metres : {0.004, 0.05, 0.1, 1.0, 250.0, 999.0, 1000.0, 1737400.0, 7e8, -1343.5, 0.0}) {
    const std::string text = formatQuantity(metres, Quantity::Length);
    EXPECT_DOUBLE_EQ(parseQuantity(text, Quantity::Length).value(), metres) << text;
  }
  for (const double degrees : {-90.0, 0.0, 52.0, 359.5}) {
    const double radians = degrees * std::numbers::pi / 180;
    EXPECT_DOUBLE_EQ(parseQuantity(formatQuantity(radians, Quantity::Angle), Quantity::Angle).value(), radians);
  }
}

TEST(QuantityText, QuotedTextIsOneShortPrintableLine) {
  EXPECT_EQ(quotedForMessage("a\"b\\c\nd\x01\xff"), R"("a\"b\\c\x0ad\x01\xff")");
  EXPECT_EQ(quotedForMessage(std::string(1000, 'x')).size(), 65u);
}

TEST(QuantityText, ATypingMistakeFindsItsWordAndAnotherWordDoesNot) {
  const std::array<std::string_view, 4> words{"radius", "name", "seed", "sun"};
  EXPECT_EQ(nearestWord("radios", words), "radius");
  EXPECT_EQ(nearestWord("raduis", words), "radius");
  EXPECT_EQ(nearestWord("nmae", words), "name");
  EXPECT_EQ(nearestWord("snu", words), "sun");
  EXPECT_EQ(nearestWord("colour", words), "");
  EXPECT_EQ(nearestWord("x", words), "");
  EXPECT_EQ(nearestWord("", words), "");
}

}  // namespace
}  // namespace terrane

#include "client/controls/frame_budget.h"

#include <gtest/gtest.h>

#include <cmath>

namespace terrane {
namespace {

// A machine whose frames cost a fixed part and a part that falls with the square of the error.
double frameMs(double fixedMs, double detailMs, double errorPixels) {
  return fixedMs + detailMs * 4 / (errorPixels * errorPixels);
}

TEST(FrameBudget, OffByDefaultItNeverTouchesTheError) {
  FrameBudget budget(0, 2);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(budget.frame(500), 2);
  EXPECT_TRUE(budget.steady());
}

TEST(FrameBudget, SettlesWithinTheBudgetAndThenStaysWhereItIs) {
  for (const double detailMs : {20.0, 60.0, 200.0, 900.0}) {
    FrameBudget budget(33, 2);
    double error = 2;
    for (int i = 0; i < 400; ++i) error = budget.frame(frameMs(4, detailMs, error));
    EXPECT_LE(frameMs(4, detailMs, error), 33 * 1.05) << detailMs;
    EXPECT_TRUE(budget.steady());
    const double settled = error;
    for (int i = 0; i < 400; ++i) error = budget.frame(frameMs(4, detailMs, error));
    EXPECT_EQ(error, settled) << "swings at " << detailMs;
  }
}

TEST(FrameBudget, GivesDetailBackOnceThereIsRoom) {
  FrameBudget budget(33, 2);
  double error = 2;
  for (int i = 0; i < 300; ++i) error = budget.frame(frameMs(4, 300, error));
  EXPECT_GT(error, 4);
  for (int i = 0; i < 300; ++i) error = budget.frame(frameMs(4, 10, error));
  EXPECT_EQ(error, 2);
}

TEST(FrameBudget, NeverGoesBeyondSixteenTimesTheAskedError) {
  FrameBudget budget(1, 3);
  for (int i = 0; i < 1000; ++i) budget.frame(1000);
  EXPECT_EQ(budget.errorPixels(), 48);
}

TEST(FrameBudget, OneSlowFrameIsNoReason) {
  FrameBudget budget(33, 2);
  for (int i = 0; i < 100; ++i) budget.frame(i % 5 == 2 ? 400 : 25);
  EXPECT_EQ(budget.errorPixels(), 2);
}

TEST(FrameBudget, TheSameTimesGiveTheSameErrors) {
  FrameBudget a(20, 1), b(20, 1);
  for (int i = 0; i < 500; ++i) {
    const double ms = 15 + 10 * std::sin(0.37 * i);
    EXPECT_EQ(a.frame(ms), b.frame(ms));
  }
}

TEST(FrameBudget, ANewRequestTakesEffectAtOnce) {
  FrameBudget off(0, 2), on(33, 2);
  off.setAsked(5);
  EXPECT_EQ(off.errorPixels(), 5);
  for (int i = 0; i < 50; ++i) on.frame(100);
  on.setAsked(50);
  EXPECT_EQ(on.errorPixels(), 50);
}

}  // namespace
}  // namespace terrane

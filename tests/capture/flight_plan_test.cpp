// Which frames a scripted flight draws.

#include "client/app/flight_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace terrane {
namespace {

constexpr double kRadiusMeters = 1'737'400;

Flight builtIn(const std::string& name) { return *builtInFlight(name, -0.286, 0.377, kRadiusMeters); }

TEST(FlightPlan, SoManyFramesAreSpreadOverTheWholeFlightWithAllItsPoints) {
  for (const char* name : {"descent", "orbit", "ground"}) {
    const Flight flight = builtIn(name);
    for (const std::size_t count :
         {flight.points.size(), flight.points.size() + 1, std::size_t{400}, std::size_t{2000}}) {
      SCOPED_TRACE(testing::Message() << name << ", " << count << " frames");
      const FlightPlan plan = planFlightInFrames(flight, count);
      ASSERT_EQ(plan.frames.size(), count);
      EXPECT_EQ(plan.frames.front().seconds, 0);
      EXPECT_EQ(plan.frames.back().seconds, flight.durationSeconds());
      int point = 0;
      double longest = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const PlannedFrame& frame = plan.frames[i];
        if (i > 0) {
          EXPECT_GT(frame.seconds, plan.frames[i - 1].seconds);
          longest = std::max(longest, frame.seconds - plan.frames[i - 1].seconds);
        }
        if (frame.point < 0) continue;
        EXPECT_EQ(frame.point, point++);
        EXPECT_EQ(frame.seconds, flight.points[static_cast<std::size_t>(frame.point)].seconds);
      }
      EXPECT_EQ(point, static_cast<int>(flight.points.size()));
      // Evenly: no gap is twice as long as it must be.
      if (count == 2000) {
        EXPECT_LT(longest, 2 * flight.durationSeconds() / static_cast<double>(count - flight.points.size()));
      }
    }
  }
}

TEST(FlightPlan, OfFewerFramesThanPointsEachIsAPointFromTheFirstToTheLast) {
  const Flight flight = builtIn("orbit");
  const FlightPlan plan = planFlightInFrames(flight, 10);
  ASSERT_EQ(plan.frames.size(), 10u);
  EXPECT_EQ(plan.frames.front().point, 0);
  EXPECT_EQ(plan.frames.back().point, static_cast<int>(flight.points.size()) - 1);
  for (std::size_t i = 1; i < plan.frames.size(); ++i) EXPECT_GT(plan.frames[i].point, plan.frames[i - 1].point);
  EXPECT_EQ(planFlightInFrames(flight, 1).frames.size(), 1u);
}

TEST(FlightPlan, AFlightOfOnePointStandsStill) {
  Flight flight;
  flight.points.push_back({3, {0.1, 0.2, 1000, 0, 0}});
  const FlightPlan plan = planFlightInFrames(flight, 5);
  ASSERT_EQ(plan.frames.size(), 5u);
  for (const PlannedFrame& frame : plan.frames) EXPECT_EQ(frame.pose.altitudeMeters, 1000);
  EXPECT_EQ(plan.frames.front().point, 0);
}

TEST(FlightPlan, AStepGoesThroughThePointsToo) {
  const Flight flight = builtIn("descent");
  const auto plan = planFlight(flight, 0.5, 0);
  ASSERT_TRUE(plan);
  EXPECT_EQ(std::count_if(plan->frames.begin(), plan->frames.end(), [](const auto& f) { return f.point >= 0; }),
            static_cast<std::ptrdiff_t>(flight.points.size()));
  EXPECT_EQ(plan->frames.back().seconds, flight.durationSeconds());
  EXPECT_EQ(planFlight(flight, 0.5, 7)->frames.size(), 7u) << "no more than that";
  const auto endless = planFlight(flight, 1e-9, 0);
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().field, "--step");
}

}  // namespace
}  // namespace terrane

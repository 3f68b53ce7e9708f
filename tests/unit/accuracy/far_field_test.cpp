// What the experiment `far-field` measures keeps the bound that it states.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/accuracy/experiment.h"

namespace terrane::accuracy {
namespace {

class Unwatched final : public Progress {
 public:
  void at(double) override {}
};

TEST(FarFieldExperiment, NoHeightIsFurtherOffThanItsToleranceAndRounding) {
  const auto all = experiments();
  const auto experiment = std::ranges::find(all, "far-field", &Experiment::name);
  ASSERT_NE(experiment, all.end());
  Unwatched progress;
  const Report report = experiment->run({.quick = true}, progress);
  const auto column = [&](const std::string& key) {
    return static_cast<std::size_t>(std::ranges::find(report.columns, key, &Column::key) - report.columns.begin());
  };
  const std::size_t tolerance = column("toleranceSteps"), height = column("heightSteps"),
                    beyond = column("heightsBeyond");
  double worst = 0;
  for (const auto& row : report.rows) {
    const double steps = std::get<double>(row.at(height));
    worst = std::max(worst, steps);
    EXPECT_EQ(std::get<std::int64_t>(row.at(beyond)), 0);
    if (std::get<double>(row.at(tolerance)) == 0) {
      EXPECT_EQ(steps, 0) << "the same evaluation twice";
    }
  }
  EXPECT_GT(worst, 0) << "control: something is expanded";
  EXPECT_TRUE(std::ranges::any_of(report.findings,
                                  [](const std::string& finding) { return finding.starts_with("The bound holds"); }));
}

}  // namespace
}  // namespace terrane::accuracy

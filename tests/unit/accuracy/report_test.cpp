// What terrane-accuracy writes: complete, the same in every run but for times, and safe to open.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/accuracy/plot_svg.h"
#include "tests/accuracy/report_text.h"

namespace terrane::accuracy {
namespace {

using testing::HasSubstr;
using testing::Not;

class Silent final : public Progress {
 public:
  void at(double share) override {
    EXPECT_GE(share, last_);
    EXPECT_LE(share, 1.0);
    last_ = share;
  }

 private:
  double last_ = 0;
};

Report runQuickly(const Experiment& experiment) {
  Silent progress;
  return experiment.run({.quick = true}, progress);
}

bool isTime(const Column& column) { return column.key.starts_with("time"); }

void expectFilled(const Experiment& experiment, const Report& report) {
  ASSERT_FALSE(report.findings.empty()) << experiment.name;
  // One that draws says so where there is nothing to draw on.
  EXPECT_NE(report.rows.empty(), !report.findings.front().starts_with("Not run: ")) << experiment.name;
  const auto expectWhole = [&](const Table& table) {
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << experiment.name;
    for (const Plot& plot : table.plots) EXPECT_THAT(plotSvg(plot, table), HasSubstr("<circle")) << plot.title;
  };
  expectWhole(report);
  std::set<std::string> keys;
  for (const NamedTable& table : report.more) {
    expectWhole(table);
    EXPECT_FALSE(table.rows.empty()) << table.title;
    EXPECT_TRUE(keys.insert(table.key).second) << table.key;
  }
}

void expectSameErrors(const Experiment& experiment, const Table& first, const Table& second) {
  ASSERT_EQ(first.rows.size(), second.rows.size());
  for (std::size_t r = 0; r < first.rows.size(); ++r) {
    for (std::size_t c = 0; c < first.columns.size(); ++c) {
      if (isTime(first.columns[c])) continue;
      EXPECT_EQ(first.rows[r][c], second.rows[r][c]) << experiment.name << " row " << r;
    }
  }
}

// One test, for the experiments take long: ctest runs each test in a process of its own.
TEST(Accuracy, EveryExperimentIsNamedOnceFillsItsTableAndGivesTheSameErrorsToTheLastDigitAgain) {
  std::set<std::string_view> names;
  for (const Experiment& experiment : experiments()) {
    EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
    EXPECT_FALSE(experiment.question.empty()) << experiment.name;
    const Report first = runQuickly(experiment);
    expectFilled(experiment, first);
    const Report second = runQuickly(experiment);
    expectSameErrors(experiment, first, second);
    ASSERT_EQ(first.more.size(), second.more.size()) << experiment.name;
    for (std::size_t i = 0; i < first.more.size(); ++i) expectSameErrors(experiment, first.more[i], second.more[i]);
  }
  EXPECT_GE(names.size(), 5u);
}

Finished sample() {
  Report report;
  report.columns = {{"name", "name"}, {"size", "size, m"}, {"timeNs", "time, ns"}};
  report.rows = {{std::string("a <b> & 'c'"), 0.1 + 0.2, std::int64_t{7}}, {std::string("é"), 0.0, std::int64_t{9}}};
  report.plots = {{"size over time", "timeNs", "size", "name"}};
  report.findings = {"it is < 1"};
  report.more = {{{{{"part", "part"}}, {{std::string("<i>")}}, {}}, "parts", "Parts & pieces"}};
  return {{1, "sample", "A sample", "What?", nullptr}, report};
}

TEST(Accuracy, JsonKeepsEveryDigitAndTellsTimesApart) {
  const auto document = nlohmann::json::parse(jsonOf({}, {sample()}));
  const auto& experiment = document.at("experiments").at(0);
  EXPECT_EQ(experiment.at("name"), "sample");
  EXPECT_EQ(experiment.at("rows").at(0).at("size").get<double>(), 0.1 + 0.2);
  EXPECT_EQ(experiment.at("rows").at(1).at("timeNs"), 9);
  EXPECT_EQ(experiment.at("more").at("parts").at("title"), "Parts & pieces");
  EXPECT_EQ(experiment.at("more").at("parts").at("rows").at(0).at("part"), "<i>");
}

TEST(Accuracy, ThePageNeedsNothingElseAndTakesNoTextForMarkup) {
  const std::string page = htmlOf({}, {sample()});
  for (const char* reference : {"src=", "http", "@import", "url("}) EXPECT_THAT(page, Not(HasSubstr(reference)));
  for (const char* markup : {"<b>", "<i>"}) EXPECT_THAT(page, Not(HasSubstr(markup)));
  EXPECT_THAT(page, HasSubstr("<h3>Parts &amp; pieces</h3>"));
  EXPECT_THAT(page, HasSubstr("a &lt;b&gt; &amp; &#39;c&#39;"));
  EXPECT_THAT(page, HasSubstr("1 points have no place")) << "0 on a logarithmic axis";
}

TEST(Accuracy, NumbersShowFourDigits) {
  EXPECT_EQ(shown(0.0), "0");
  EXPECT_EQ(shown(1.0), "1.000");
  EXPECT_EQ(shown(1234.56), "1235");
  EXPECT_EQ(shown(1.5e-7), "1.50e-07");
  EXPECT_EQ(shown(std::int64_t{123456789}), "123456789");
  EXPECT_EQ(shown(INFINITY), "inf");
}

}  // namespace
}  // namespace terrane::accuracy

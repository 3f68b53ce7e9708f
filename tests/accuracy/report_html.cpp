#include <fmt/format.h>

#include "tests/accuracy/plot_svg.h"
#include "tests/accuracy/report_text.h"

namespace terrane::accuracy {
namespace {

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>What accuracy costs</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #1c1c1c; background: #fff; }
h1 { font-size: 1.7rem; } h2 { margin-top: 3rem; border-top: 1px solid #ccc; padding-top: 1rem; }
.question { font-style: italic; } .finding { background: #f3f6f9; border-left: 4px solid #0072B2; padding: .4rem .8rem; margin: .5rem 0; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px; }
th, td { padding: .18rem .6rem; border-bottom: 1px solid #e2e2e2; text-align: right; white-space: nowrap; }
th { border-bottom: 2px solid #888; vertical-align: bottom; } td.text, th.text { text-align: left; }
figure { margin: 1rem 0; } svg { width: 100%; height: auto; max-width: 880px; font: 12px system-ui, sans-serif; }
figcaption { font-size: 13px; color: #444; } .grid { stroke: #ddd; } .axis { font-size: 13px; }
</style></head><body>
<h1>What accuracy costs</h1>
)";

std::string tableHtml(const Table& table) {
  std::string out = "<div class=\"scroll\"><table><tr>";
  const auto kind = [&](std::size_t c) {
    return !table.rows.empty() && std::holds_alternative<std::string>(table.rows.front()[c]) ? " class=\"text\"" : "";
  };
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    out += fmt::format("<th{}>{}</th>", kind(c), escaped(table.columns[c].title));
  out += "</tr>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) out += fmt::format("<td{}>{}</td>", kind(c), escaped(shown(row[c])));
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

}  // namespace

std::string htmlOf(const Settings& settings, const std::vector<Finished>& all) {
  std::string out = kHead;
  out += fmt::format(
      "<p>Errors are the same in every run (seed {}{}). Times are medians of this machine, taken side by side: compare "
      "them within a table.</p>\n<ul>\n",
      settings.seed, settings.quick ? ", quick: fewer samples" : "");
  for (const Finished& finished : all)
    out += fmt::format("<li><a href=\"#{0}\">{1}</a></li>\n", escaped(finished.experiment.name),
                       escaped(finished.experiment.title));
  out += "</ul>\n";
  for (const Finished& finished : all) {
    out += fmt::format("<h2 id=\"{}\">{}</h2>\n<p class=\"question\">{}</p>\n", escaped(finished.experiment.name),
                       escaped(finished.experiment.title), escaped(finished.experiment.question));
    for (const Plot& plot : finished.report.plots) out += plotSvg(plot, finished.report);
    for (const std::string& finding : finished.report.findings)
      out += "<p class=\"finding\">" + escaped(finding) + "</p>\n";
    out += tableHtml(finished.report);
    for (const NamedTable& table : finished.report.more) {
      out += "<h3>" + escaped(table.title) + "</h3>\n";
      for (const Plot& plot : table.plots) out += plotSvg(plot, table);
      out += tableHtml(table);
    }
  }
  return out + "</body></html>\n";
}

}  // namespace terrane::accuracy

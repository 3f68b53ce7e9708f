#include "tests/accuracy/report_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace terrane::accuracy {
namespace {

/// Width in columns of a terminal: UTF-8's continuation bytes take none.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, widthOf(text)), ' ');
  return right ? space + text : text + space;
}

std::string tableText(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    std::size_t width = widthOf(table.columns[c].title);
    for (const auto& row : table.rows) width = std::max(width, widthOf(shown(row[c])));
    widths.push_back(width);
  }
  std::string out;
  const auto line = [&](const auto& cell) {
    for (std::size_t c = 0; c < widths.size(); ++c) out += (c > 0 ? "  " : "") + cell(c);
    out += '\n';
  };
  const auto isText = [&](std::size_t c) {
    return !table.rows.empty() && std::holds_alternative<std::string>(table.rows.front()[c]);
  };
  line([&](std::size_t c) { return padded(table.columns[c].title, widths[c], !isText(c)); });
  for (const auto& row : table.rows) line([&](std::size_t c) { return padded(shown(row[c]), widths[c], !isText(c)); });
  return out;
}

/// Adds "columns" and "rows".
void addTable(const Table& table, nlohmann::ordered_json& out) {
  out["columns"] = nlohmann::ordered_json::object();
  for (const Column& column : table.columns) out["columns"][column.key] = column.title;
  auto& rows = out["rows"] = nlohmann::ordered_json::array();
  for (const auto& row : table.rows) {
    nlohmann::ordered_json entry;
    for (std::size_t c = 0; c < row.size(); ++c)
      std::visit([&](const auto& value) { entry[table.columns[c].key] = value; }, row[c]);
    rows.push_back(std::move(entry));
  }
}

}  // namespace

std::string shown(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
  const double number = std::get<double>(value);
  const double size = std::fabs(number);
  if (number == 0 || !std::isfinite(number)) return fmt::format("{}", number);
  if (size >= 1e5 || size < 1e-3) return fmt::format("{:.2e}", number);
  const int digits = std::clamp(3 - static_cast<int>(std::floor(std::log10(size))), 0, 6);
  return fmt::format("{:.{}f}", number, digits);
}

std::string textOf(const Finished& finished) {
  const Report& report = finished.report;
  std::string out = fmt::format("\n== {}: {}\n{}\n\n", finished.experiment.name, finished.experiment.title,
                                finished.experiment.question);
  out += tableText(report);
  for (const NamedTable& table : report.more) out += fmt::format("\n{}:\n{}", table.title, tableText(table));
  for (const std::string& finding : report.findings) out += "\n* " + finding;
  return out + '\n';
}

std::string jsonOf(const Settings& settings, const std::vector<Finished>& all) {
  nlohmann::ordered_json document;
  document["settings"] = {{"quick", settings.quick}, {"seed", settings.seed}};
  auto& list = document["experiments"] = nlohmann::ordered_json::array();
  for (const Finished& finished : all) {
    nlohmann::ordered_json one;
    one["name"] = finished.experiment.name;
    one["title"] = finished.experiment.title;
    addTable(finished.report, one);
    for (const NamedTable& table : finished.report.more) {
      auto& added = one["more"][table.key];
      added["title"] = table.title;
      addTable(table, added);
    }
    one["findings"] = finished.report.findings;
    list.push_back(std::move(one));
  }
  return document.dump(1) + "\n";
}

}  // namespace terrane::accuracy

#include "tests/accuracy/plot_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "tests/accuracy/report_text.h"

namespace terrane::accuracy {
namespace {

constexpr double kWidth = 880, kHeight = 420, kLeft = 78, kRight = 300, kTop = 16, kBottom = 52;
/// Colours that differ for most kinds of colour blindness (Okabe and Ito), and darker ones after them.
constexpr std::array<const char*, 12> kColors{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9",
                                              "#000000", "#7F3C8D", "#8C564B", "#666666", "#A3A500", "#AA0044"};

std::optional<double> number(const Value& value) {
  if (const auto* real = std::get_if<double>(&value)) return std::isfinite(*real) ? std::optional(*real) : std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::nullopt;
}

std::size_t columnAt(const Table& table, const std::string& key) {
  const auto found = std::ranges::find(table.columns, key, &Column::key);
  return static_cast<std::size_t>(found - table.columns.begin());
}

/// Maps values to pixels; linear or by decades.
class Axis {
 public:
  Axis(bool logarithmic, double begin, double end) : logarithmic_(logarithmic), begin_(begin), end_(end) {}
  void include(double value) {
    const double v = logarithmic_ ? std::log10(value) : value;
    low_ = std::min(low_, v);
    high_ = std::max(high_, v);
  }
  void settle() {
    if (logarithmic_) {
      low_ = std::floor(low_ - 1e-9);
      high_ = std::ceil(high_ + 1e-9);
    } else {
      const double margin = std::max(0.05 * (high_ - low_), 1e-12 * std::max(std::fabs(low_), 1.0));
      low_ = low_ >= 0 && low_ < 0.4 * high_ ? 0 : low_ - margin;
      high_ += margin;
    }
  }
  double at(double value) const {
    const double v = logarithmic_ ? std::log10(value) : value;
    return begin_ + (v - low_) / (high_ - low_) * (end_ - begin_);
  }
  /// Positions of grid lines with their labels.
  std::vector<std::pair<double, std::string>> ticks() const {
    std::vector<std::pair<double, std::string>> marks;
    if (logarithmic_) {
      const double stride = std::max(1.0, std::ceil((high_ - low_) / 8));
      for (double decade = low_; decade <= high_ + 1e-9; decade += stride)
        marks.emplace_back(at(std::pow(10.0, decade)), fmt::format("1e{:.0f}", decade));
      return marks;
    }
    const double raw = (high_ - low_) / 6, decade = std::pow(10.0, std::floor(std::log10(raw)));
    const double stride = decade * (raw / decade > 5 ? 10 : raw / decade > 2 ? 5 : raw / decade > 1 ? 2 : 1);
    for (double value = std::ceil(low_ / stride) * stride; value <= high_; value += stride)
      marks.emplace_back(at(value), fmt::format("{:.4g}", value));
    return marks;
  }

 private:
  bool logarithmic_;
  double begin_, end_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

struct Line {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

struct Lines {
  std::vector<Line> lines;
  std::size_t leftOut = 0;
};

Lines linesOf(const Plot& plot, const Table& table) {
  const std::size_t x = columnAt(table, plot.x), y = columnAt(table, plot.y), series = columnAt(table, plot.series);
  Lines result;
  for (const auto& row : table.rows) {
    const auto px = number(row[x]), py = number(row[y]);
    if (!px || !py || (plot.logX && *px <= 0) || (plot.logY && *py <= 0)) {
      ++result.leftOut;
      continue;
    }
    const std::string name = shown(row[series]);
    auto line = std::ranges::find(result.lines, name, &Line::name);
    if (line == result.lines.end()) line = result.lines.insert(line, Line{name, {}});
    line->points.emplace_back(*px, *py);
  }
  return result;
}

std::string grid(const Axis& x, const Axis& y) {
  std::string out;
  for (const auto& [at, label] : x.ticks())
    out += fmt::format(
        "<path d='M{0:.1f} {1}V{2}' class='grid'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4}</text>\n", at,
        kTop, kHeight - kBottom, kHeight - kBottom + 18, label);
  for (const auto& [at, label] : y.ticks())
    out +=
        fmt::format("<path d='M{1} {0:.1f}H{2}' class='grid'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5}</text>\n",
                    at, kLeft, kWidth - kRight, kLeft - 6, at + 4, label);
  return out;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '\'':
        out += "&#39;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string plotSvg(const Plot& plot, const Table& table) {
  const Lines all = linesOf(plot, table);
  if (all.lines.empty()) return {};
  Axis x(plot.logX, kLeft, kWidth - kRight), y(plot.logY, kHeight - kBottom, kTop);
  for (const Line& line : all.lines) {
    for (const auto& [px, py] : line.points) {
      x.include(px);
      y.include(py);
    }
  }
  x.settle();
  y.settle();
  std::string out = fmt::format("<figure><svg viewBox='0 0 {} {}' role='img' aria-label='{}'>\n", kWidth, kHeight,
                                escaped(plot.title));
  out += grid(x, y);
  for (std::size_t i = 0; i < all.lines.size(); ++i) {
    const char* color = kColors[i % kColors.size()];
    std::string path;
    for (const auto& [px, py] : plot.joined ? all.lines[i].points : decltype(all.lines[i].points){})
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x.at(px), y.at(py));
    if (!path.empty()) out += fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='1.6'/>\n", path, color);
    for (const auto& [px, py] : all.lines[i].points)
      out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='3.4' fill='{}'/>\n", x.at(px), y.at(py), color);
    const double at = kTop + 12 + 17 * static_cast<double>(i);
    out += fmt::format("<circle cx='{}' cy='{}' r='4' fill='{}'/><text x='{}' y='{}'>{}</text>\n", kWidth - kRight + 16,
                       at - 4, color, kWidth - kRight + 26, at, escaped(all.lines[i].name));
  }
  const auto title = [&](const std::string& key) { return escaped(table.columns[columnAt(table, key)].title); };
  out += fmt::format("<text x='{}' y='{}' text-anchor='middle' class='axis'>{}</text>\n", (kLeft + kWidth - kRight) / 2,
                     kHeight - 10, title(plot.x));
  out += fmt::format("<text transform='translate(16 {}) rotate(-90)' text-anchor='middle' class='axis'>{}</text>\n",
                     (kTop + kHeight - kBottom) / 2, title(plot.y));
  out += "</svg><figcaption>" + escaped(plot.title);
  if (all.leftOut > 0) out += fmt::format(" ({} points have no place on these axes: 0 or infinite)", all.leftOut);
  return out + "</figcaption></figure>\n";
}

}  // namespace terrane::accuracy

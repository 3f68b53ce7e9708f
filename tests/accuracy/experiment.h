#pragma once
// What an experiment of terrane-accuracy is: a question, a table whose rows say what accuracy costs in time, plots of
// it, further tables where one cannot hold it all, and findings in plain words. An experiment is one file that
// registers itself; nothing else knows of it.
//
// Everything but times is deterministic: equal settings give equal rows to the last digit. Keys of times begin with
// "time", so that a reader of accuracy.json can leave them out.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace terrane::accuracy {

using Value = std::variant<std::string, double, std::int64_t>;

struct Column {
  std::string key;    ///< in accuracy.json
  std::string title;  ///< for people; names the unit ("error, u^2")
};

/// One point a row, one colour for each value of the series' column; columns by key.
struct Plot {
  std::string title;
  std::string x, y, series;
  bool logX = true, logY = true;
  bool joined = true;  ///< by lines, row after row; not where rows are choices and no steps of anything
};

struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<Value>> rows;
  std::vector<Plot> plots;
};

/// One more table of an experiment.
struct NamedTable : Table {
  std::string key;    ///< in accuracy.json
  std::string title;  ///< for people
};

struct Report : Table {
  std::vector<std::string> findings;  ///< plain words, with figures from the rows
  std::vector<NamedTable> more;
};

struct Settings {
  bool quick = false;
  std::uint64_t seed = 20260101;
};

class Progress {
 public:
  virtual ~Progress() = default;
  virtual void at(double share) = 0;  ///< 0 .. 1 of this experiment
};

struct Experiment {
  int order = 0;  ///< in the report
  std::string_view name, title, question;
  Report (*run)(const Settings& settings, Progress& progress) = nullptr;
};

/// At namespace scope of an experiment's file.
class Registration {
 public:
  explicit Registration(const Experiment& experiment);
};

/// All that is linked in, by order.
std::span<const Experiment> experiments();

}  // namespace terrane::accuracy

#pragma once
// A report as people and programs read it.

#include <string>
#include <vector>

#include "tests/accuracy/experiment.h"

namespace terrane::accuracy {

struct Finished {
  Experiment experiment;
  Report report;
};

/// Four significant digits; text as it is.
std::string shown(const Value& value);

/// A table with its findings, for a terminal.
std::string textOf(const Finished& finished);

/// accuracy.json: {"settings": …, "experiments": [{"name", "columns", "rows": [{key: value}], "more", "findings"}]};
/// numbers with all their digits, null for what is infinite. "more", where there is more than one table: {key:
/// {"title", "columns", "rows"}}.
std::string jsonOf(const Settings& settings, const std::vector<Finished>& all);

/// A page that needs nothing but itself.
std::string htmlOf(const Settings& settings, const std::vector<Finished>& all);

}  // namespace terrane::accuracy

#pragma once
// A plot as SVG text: points joined in the order of their rows, one colour and legend line a series.

#include <string>

#include "tests/accuracy/experiment.h"

namespace terrane::accuracy {

/// Rows whose x or y is no number, or not above 0 on a logarithmic axis, are left out, and the plot says how many.
std::string plotSvg(const Plot& plot, const Table& table);

/// For text in HTML and SVG.
std::string escaped(std::string_view text);

}  // namespace terrane::accuracy

#pragma once
// What experiments share that draw: whether there is anything to draw on, and what they say where there is not.

#include <limits>
#include <optional>
#include <string>

#include "common/result.h"
#include "tests/accuracy/experiment.h"

namespace terrane::accuracy {

/// No rows and one finding, which begins "Not run: ".
Report notRun(const Error& why);

/// Opens the shared headless window, its context current, and holds memory as the viewer does (frames of software GL
/// take theirs from the heap). A report that says why where there is none.
std::optional<Report> whyNotDrawn();

/// What the times of a report are times of.
std::string picturesText(int widthPixels, int heightPixels);

/// The least and the most of what was included, for findings over several views.
class Span {
 public:
  void include(double value);
  double most() const { return most_; }
  /// "1.2 to 3.4", or one figure where both would be written alike.
  std::string text() const;

 private:
  double least_ = std::numeric_limits<double>::infinity(), most_ = -std::numeric_limits<double>::infinity();
};

}  // namespace terrane::accuracy

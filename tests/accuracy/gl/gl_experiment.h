#pragma once
// What experiments share that draw: whether there is anything to draw on, and what they say where there is not.

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

}  // namespace terrane::accuracy

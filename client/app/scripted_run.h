#pragma once
// A run that goes to its end by itself: settle at a camera, fly a flight at a fixed time step, capture, count, leave.
// GL thread only.

#include <chrono>

#include "client/app/view_options.h"
#include "client/gl/window.h"

namespace terrane {

/// Returns the process's exit status: 0, or 1 after one line on stderr. start: when the program began, for msToSettle.
int runScripted(const ViewOptions& options, Window& window, std::chrono::steady_clock::time_point start);

}  // namespace terrane

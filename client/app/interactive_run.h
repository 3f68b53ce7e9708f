#pragma once
// The viewer that follows a person's hands: window events, camera controls or a flight, overlay, screenshots. It draws
// only when something changed and sleeps otherwise. GL thread only.

#include <chrono>

#include "client/app/view_options.h"
#include "client/gl/window.h"

namespace terrane {

/// Returns the process's exit status once the window is closed.
int runInteractive(const ViewOptions& options, Window& window, std::chrono::steady_clock::time_point start);

}  // namespace terrane

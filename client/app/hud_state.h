#pragma once
// What the overlay shows of a session, in one place for both loops. GL thread only.

#include "client/app/run_statistics.h"
#include "client/app/view_session.h"
#include "client/render/hud.h"

namespace terrane {

/// frameMs: where the last frames' times are kept while the state is in use.
HudState hudStateOf(const ViewSession& session, const FrameTimes& times, const DrawStats& drawn,
                    std::vector<float>& frameMs);

/// Fills in what the session knows at the run's end.
void describeSession(const ViewSession& session, const ViewOptions& options, RunStatistics& statistics);

}  // namespace terrane

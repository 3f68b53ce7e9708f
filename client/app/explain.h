#pragma once
// --explain: each row of the table of effects, on or off, why, and what it costs in the view at hand. GL thread only.

#include <string>

#include "client/app/view_session.h"

namespace terrane {

/// Several lines of text. The cost of a client's effect is measured: the view is drawn with it and without it, turn
/// about, by two renderers that differ in nothing else.
std::string explainEffects(ViewSession& session);

}  // namespace terrane

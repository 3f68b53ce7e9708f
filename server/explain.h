#pragma once
// What --explain prints: the bodies of a scene and their fields, every effect of the table with the reason why it is on
// or off and its cost, and what was really constructed. Main thread only.

#include <string>

#include "common/scene/scene.h"
#include "server/http/tile_service.h"

namespace terrane {

/// Makes the scene's service, so that the counters say what a server of this scene constructs.
std::string explainScene(const Scene& scene, const TileService::Options& options);

}  // namespace terrane

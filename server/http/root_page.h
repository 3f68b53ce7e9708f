#pragma once
// The page at "/": what this server is, what it serves, and how to look at it. Plain HTML without scripts. Thread-safe.

#include <string>

#include "proto/scene_json.h"

namespace terrane {

std::string rootPage(const SceneInfo& scene);

}  // namespace terrane

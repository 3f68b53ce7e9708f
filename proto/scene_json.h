#pragma once
// scene.json: what a viewer must know before it asks for the first tile. Thread-safe.

#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "common/scene/effects.h"
#include "common/tiling/tile_bounds.h"
#include "common/view/tile_selection.h"

namespace terrane {

struct BodyInfo {
  std::string name;
  std::string revision;  ///< hash of what shapes the body's tile bytes
  std::vector<Scheme> schemes;
  int cellsPerEdge = 64;
  /// Its centre in the scene's frame, metres, each coordinate within kMaxPositionMeters; the axes are the body frame's.
  /// A document may leave it out: then it is the origin.
  glm::dvec3 positionScene{0.0};
  SelectionBody selection;  ///< radius, levels, heights, geometric errors
};

struct SceneInfo {
  std::string name;
  std::string summary;
  std::vector<BodyInfo> bodies;
  std::vector<EffectCall> effects;
  std::vector<std::string> unknownEffects = {};  ///< read: names that this build does not know, any text, each once
};

std::string writeSceneJson(const SceneInfo& scene);
/// Any bytes: a scene or one error naming the key, e.g. "bodies[0].radiusMeters". Unknown effects are only named,
/// so that an old viewer opens a newer server's scene.
Result<SceneInfo> readSceneJson(std::string_view json);

}  // namespace terrane

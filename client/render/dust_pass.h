#pragma once
// Draws the grains of the tiles in view: solid meshes, placed by the instance as a double-float root minus the camera
// plus the grain's own vertex, and then, from the depth of ground and grains, the shadows that they cast and the
// dimness where they touch the ground. GL thread only.

#include <memory>

#include "client/dust/grain_field.h"
#include "client/render/effect_pass.h"

namespace terrane {

/// Null if the body's radius is not known. Errors: Unsupported ("shader").
Result<std::unique_ptr<EffectPass>> makeDustPass(const DustSettings& settings, const PassContext& context);

}  // namespace terrane

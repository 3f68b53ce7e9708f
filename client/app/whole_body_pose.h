#pragma once
// Where a viewer starts. Pure function, thread-safe.

#include "common/view/camera.h"
#include "proto/scene_json.h"

namespace terrane {

/// Where a viewer starts without --camera: the whole body in view, the sun to one side where the scene has one.
ViewPose wholeBodyPose(const SceneInfo& scene, const BodyInfo& body, double verticalFieldOfView, int widthPixels,
                       int heightPixels);

}  // namespace terrane

#pragma once
// What a shader is told to find the ground that a pixel shows from the depth that was left there
// (client/shaders/ground_position.glsl). GL thread only.

#include "client/gl/shader_program.h"
#include "common/view/camera.h"

namespace terrane {

/// Of the program in use; the depth is the texture of unit 0.
void setGroundPosition(const gl::Program& program, const Camera& camera);

}  // namespace terrane

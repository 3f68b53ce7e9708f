#pragma once
// What this GPU's (or its driver's) arithmetic really does, found by running it: whether integers add and convert
// exactly, and whether the error-free transformations of double-float survive the compiler. The values come from vertex
// attributes and are captured by transform feedback. GL thread only.

#include "client/gl/capabilities.h"
#include "client/render/tile_renderer.h"
#include "common/result.h"

namespace terrane {

/// Chooses Integer if it is exact, else DoubleFloat if that is, else Cpu. Errors: Unsupported ("shader").
Result<SelfTestReport> runGpuSelfTest(const gl::Capabilities& capabilities);

}  // namespace terrane

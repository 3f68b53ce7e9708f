// A grain as it lies on the ground (client/render/tile_grains.h), relative to the camera.
#include "double_float.glsl"

layout(location = 3) in vec4 rootHighAndRadius;  // body frame, metres; half its width
layout(location = 4) in vec4 rootLowAndCenter;   // its middle over its root, metres
layout(location = 5) in vec4 turn;               // quaternion
layout(location = 6) in vec3 groundNormal;
layout(location = 7) in uint variant;
layout(location = 8) in vec4 groundColor;   // on the display's curve; half its shade
layout(location = 9) in vec2 flatAndDetail; // height over width; share of its mesh's own shape

uniform vec3 cameraHigh, cameraLow;
uniform float pixelsPerRadian;
uniform vec2 seenPixels;  // diameters between which a grain grows from nothing

struct LyingGrain {
  vec3 root;        // relative to the camera
  vec3 up;          // unit, the ground's normal
  float radius;     // half its width, metres
  float flattening;
  float center;     // of its middle over the root, metres
};

LyingGrain lyingGrain() {
  vec3 root = subtractPairToFloat(DoubleFloat3(rootHighAndRadius.xyz, rootLowAndCenter.xyz), DoubleFloat3(cameraHigh, cameraLow));
  float pixels = 2.0 * rootHighAndRadius.w * pixelsPerRadian / max(length(root), 1e-6);
  float grown = smoothstep(seenPixels.x, seenPixels.y, pixels);
  return LyingGrain(root, normalize(groundNormal), grown * rootHighAndRadius.w, flatAndDetail.x, grown * rootLowAndCenter.w);
}

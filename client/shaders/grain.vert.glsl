// A vertex of a grain: its mesh, shaped, turned, flattened, set on its root.
#include "grain.glsl"
#include "projection.glsl"

layout(location = 0) in vec3 direction;
layout(location = 1) in vec4 radii;         // of each shape
layout(location = 2) in vec4 coarserRadii;  // where the coarser mesh has this vertex

uniform float exposure;

out vec3 color;         // as the display wants it, in full light
out vec3 surface;       // on the grain, in half widths from its middle, body axes
out vec3 towardsEye;
out float overGround;   // height over the ground in half heights
flat out vec3 up;
flat out float flattening;

void main() {
  LyingGrain grain = lyingGrain();
  float radius = mix(coarserRadii[variant], radii[variant], flatAndDetail.y);
  vec3 turned = direction + 2.0 * cross(turn.xyz, cross(turn.xyz, direction) + turn.w * direction);
  float along = dot(turned, grain.up);
  surface = radius * (turned + (grain.flattening - 1.0) * along * grain.up);
  up = grain.up;
  flattening = grain.flattening;
  overGround = radius * along + grain.center / max(grain.flattening * grain.radius, 1e-9);
  vec3 relative = grain.root + (grain.center * grain.up + grain.radius * surface);
  towardsEye = -relative;
  color = groundColor.rgb * pow(2.0 * groundColor.a, 1.0 / DISPLAY_GAMMA) * exposure;
  gl_Position = clipPosition(relative);
}

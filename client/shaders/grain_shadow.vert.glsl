// The box of space in which a grain dims what is there: around it, and along its shadow on the ground. A strip of 14 corners.
#include "grain.glsl"
#include "projection.glsl"
#ifdef EFFECT_SUN
#include "sun.glsl"
#endif

flat out vec3 center;     // of the spheroid, relative to the camera
flat out vec3 up;
flat out vec3 sizes;      // half width, half height, metres; a pixel there, in half widths
flat out float centerHeight;  // of the middle over the ground, metres
flat out float shadowLight;   // what is left in the shadow of the light without

const float kOcclusionReach = 2.2;  // half widths from the middle
const float kShadowReach = 5.5;     // as grain_shadow.frag.glsl has it

void main() {
  LyingGrain grain = lyingGrain();
  up = grain.up;
  center = grain.root + grain.center * grain.up;
  centerHeight = grain.center;
  float radius = PEBBLE_RADIUS * grain.radius, height = radius * grain.flattening;
  sizes = vec3(max(radius, 1e-9), max(height, 1e-9), length(center) / (pixelsPerRadian * max(radius, 1e-9)));
  vec3 along = abs(up.x) < 0.8 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);  // any, but for a shadow's direction
  float reach = 0.0;
  shadowLight = 1.0;
#ifdef EFFECT_SUN
  float elevation = dot(towardsSun, up);
  vec3 fromSun = elevation * up - towardsSun;
  float across = length(fromSun);
  if (across > 1e-4) along = fromSun;
  if (elevation > 0.0) {
    float light = max(signedSunlight(up, -normalize(center)), 0.0);
    float top = max(grain.center + height, 0.0) / max(radius, 1e-9);
    reach = min(top * across / elevation + 1.0, kShadowReach);
    shadowLight = ambient / max(light + ambient, 1e-6);
  }
#endif
  along = normalize(along - dot(along, up) * up);
  vec3 side = cross(up, along);
  // A strip around the box, as bits of x, y, z.
  int corner = gl_VertexID;
  vec3 at = vec3(((0x287a >> corner) & 1) != 0, ((0x02af >> corner) & 1) != 0, ((0x31e3 >> corner) & 1) != 0);
  vec3 low = vec3(-kOcclusionReach, -kOcclusionReach, -1.2), high = vec3(max(reach + 0.3, kOcclusionReach), kOcclusionReach, 1.4);
  vec3 place = radius * mix(low, high, at);
  gl_Position = clipPosition(grain.root + place.x * along + place.y * side + place.z * up);
}

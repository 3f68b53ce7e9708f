// A grain's surface: flat faces with slightly rounded normals, lit as the ground is, and by what light the ground sends back; dim at its foot.
#include "depth.glsl"
#ifdef EFFECT_SUN
#include "sun.glsl"
#endif

in vec3 color;
in vec3 surface;
in vec3 towardsEye;
in float overGround;
flat in vec3 up;
flat in float flattening;

layout(location = 0) out vec4 pixel;

const float kRounding = 0.3;        // share of the round normal in a face's
const float kGroundLight = 0.09;    // of the light on it that the ground sends back
const float kFootLight = 0.45;      // left at the foot
const float kFootHeight = 0.7;      // half heights over the ground where nothing is lost any more

void main() {
  vec3 eye = normalize(towardsEye);
  vec3 face = cross(dFdx(surface), dFdy(surface));
  // Of the spheroid below this point: from the point, not from the corners, so that a mesh and the same one with more corners look alike.
  vec3 round = normalize(surface + (1.0 / max(flattening * flattening, 1e-4) - 1.0) * dot(surface, up) * up);
  // Which way a face looks is not for the eye to tell at its rim: the round normal knows.
  float size = length(face);
  face = size > 0.0 ? face * (dot(face, round) < 0.0 ? -1.0 / size : 1.0 / size) : round;
  vec3 normal = normalize(mix(face, round, kRounding));
  float foot = mix(kFootLight, 1.0, smoothstep(-0.2, kFootHeight, overGround));
#ifdef EFFECT_SUN
  float ground = kGroundLight * (0.5 - 0.5 * dot(normal, up)) * max(signedSunlight(up, eye), 0.0);
  float light = (lightOf(signedSunlight(normal, eye)) + ground) * foot;
#else
  float light = foot * (0.75 + 0.25 * dot(normal, up));
#endif
  pixel = vec4(color * pow(light, 1.0 / DISPLAY_GAMMA), 1.0);
  writeDepth();
}

// What a grain takes of the light where the scene is seen through its box: the shadow of its spheroid, by the ray from there to the sun, and
// the part of the sky that it hides. Multiplies the colour.
#include "ground_position.glsl"
#ifdef EFFECT_SUN
#include "sun.glsl"
#endif

flat in vec3 center;
flat in vec3 up;
flat in vec3 sizes;
flat in float centerHeight;
flat in float shadowLight;

layout(location = 0) out vec4 pixel;

const float kOcclusion = 0.6;        // of the light, where the whole sky is hidden
const float kSunRadius = 0.00465;    // radians
const float kShadowReach = 5.5;      // half widths, over the last three of which a shadow fades

#ifdef EFFECT_SUN
// What is turned from the sun has no light to lose.
float litShare(vec3 point) {
  vec3 facing = cross(alongGround(gl_FragCoord.xy, vec2(1.0, 0.0), point), alongGround(gl_FragCoord.xy, vec2(0.0, 1.0), point));
  return smoothstep(0.0, 0.1, dot(facing, towardsSun) / max(length(facing), 1e-20));
}
#endif

void main() {
  float depth = depthAt(gl_FragCoord.xy);
  if (depth <= 0.0) discard;
  vec3 point = groundRelative(gl_FragCoord.xy, depth);
  // Where the grain is the unit sphere.
  vec3 away = point - center;
  float rising = 1.0 / sizes.y - 1.0 / sizes.x, aboveMiddle = dot(away, up);
  vec3 at = away / sizes.x + rising * aboveMiddle * up;
  float square = dot(at, at), overGround = (aboveMiddle + centerHeight) / sizes.y;
  // The share of the sky that a sphere hides from a level point, with its part below the horizon left out (after Quilez, "Sphere -
  // occlusion"); 0 at the box' sides.
  float hidden = pow(clamp(0.5 * (1.0 - dot(at, up)) / square, 0.0, 1.0), 1.5);
  float light = 1.0 - kOcclusion * max(hidden - 0.03, 0.0);
#ifdef EFFECT_SUN
  vec3 sun = towardsSun / sizes.x + rising * dot(towardsSun, up) * up;
  float meters = -dot(at, sun) / dot(sun, sun);  // towards the sun, to where the ray comes nearest
  if (meters > 0.0) {
    float soft = clamp(sizes.z + kSunRadius * meters / sizes.x, 0.02, 0.9);
    float shade = 1.0 - smoothstep(1.0 - soft, 1.0 + soft, length(at + meters * sun));
    shade *= 1.0 - smoothstep(kShadowReach - 3.0, kShadowReach, meters / sizes.x);
    // Beside the grain the ground is as its root's; only what lies higher or lower is asked.
    float elsewhere = smoothstep(0.4, 0.9, abs(overGround));
    if (shade * elsewhere > 0.0) shade *= mix(1.0, litShare(point), elsewhere);
    light *= 1.0 - shade * (1.0 - shadowLight);
  }
#endif
  // What belongs to the grain itself is lit by its own normals.
  float itself = smoothstep(0.1, 0.3, overGround) * (1.0 - smoothstep(1.4, 1.9, square));
  pixel = vec4(vec3(pow(mix(light, 1.0, itself), 1.0 / DISPLAY_GAMMA)), 1.0);
}

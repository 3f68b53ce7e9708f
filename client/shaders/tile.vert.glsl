// A terrain vertex: place it, and light it. Light is computed here and only its cut-off and the display's curve per pixel: triangles
// are a few pixels large, and software GL pays for every operation on every 4 x 4 block that a triangle touches.
#include "placement.glsl"
#include "projection.glsl"

layout(location = 1) in vec4 vertexNormal;
layout(location = 2) in vec4 vertexColor;  // (reflectance / kColorScale)^(1 / DISPLAY_GAMMA)

uniform float exposure;  // light on the display per unit of light that soil of reflectance kColorScale sends back, on the same curve
uniform vec3 tint;

#ifdef EFFECT_SUN
#include "sun.glsl"
out float signedLight;
#endif

out vec3 color;  // as the display wants it, in full light
invariant gl_Position;

void main() {
  vec3 relative = relativePosition();
  gl_Position = clipPosition(relative);
#ifdef EFFECT_SUN
  signedLight = signedSunlight(vertexNormal.xyz, -normalize(relative));
#endif
  color = vertexColor.rgb * exposure * tint;
}

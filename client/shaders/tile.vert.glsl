// A terrain vertex: place it, and light it. Light is computed here and not per pixel: triangles are a few pixels large, and software
// GL pays for every operation on every 4 x 4 block that a triangle touches.
#include "placement.glsl"
#include "projection.glsl"

layout(location = 1) in vec4 vertexNormal;
layout(location = 2) in vec4 vertexColor;  // (reflectance / kColorScale)^(1 / DISPLAY_GAMMA)

uniform float exposure;  // light on the display per unit of light that soil of reflectance kColorScale sends back
uniform vec3 tint;

#ifdef EFFECT_SUN
#include "sun.glsl"
#endif

out vec3 color;  // as the display wants it
invariant gl_Position;

void main() {
  vec3 relative = relativePosition();
  gl_Position = clipPosition(relative);
  float light = exposure;
#ifdef EFFECT_SUN
  light *= litFraction(vertexNormal.xyz, -normalize(relative));
#endif
  // The display's curve is a power, and a power of a product is the product of powers: one pow, not three.
  color = vertexColor.rgb * pow(light, 1.0 / DISPLAY_GAMMA) * tint;
}

// A terrain vertex: place it, and light it. Light is computed here and not per pixel: triangles are a few pixels large, and software
// GL pays for every interpolated value of every triangle.
#include "placement.glsl"
#include "projection.glsl"

layout(location = 1) in vec4 vertexNormal;
layout(location = 2) in vec4 vertexColor;

uniform float exposure;  // display value per unit of reflected light
uniform vec3 tint;

#ifdef EFFECT_SUN
#include "sun.glsl"
#endif

out vec3 color;  // as the display wants it (sRGB)
invariant gl_Position;

vec3 toDisplay(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThan(c, vec3(0.0031308)));
}

void main() {
  vec3 relative = relativePosition();
  gl_Position = clipPosition(relative);
  vec3 light = vertexColor.rgb * exposure;
#ifdef EFFECT_SUN
  light *= litFraction(normalize(vertexNormal.xyz), -normalize(relative));
#endif
  color = toDisplay(light) * tint;
}

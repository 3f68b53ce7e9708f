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
#ifdef MORPH
  MorphedVertex vertex = morphedVertex();
  vec3 relative = morphedPosition(vertex);
#else
  vec3 relative = relativePosition();
#endif
  gl_Position = clipPosition(relative);
  vec3 ownColor = vertexColor.rgb;
#ifdef EFFECT_SUN
  vec3 towardsEye = -normalize(relative);
  signedLight = signedSunlight(vertexNormal.xyz, towardsEye);
#endif
#ifdef MORPH
  // As the parent looks there: between its vertices it interpolates light and colour, not normals.
  ownColor = mix(ownColor, 0.5 * (parentColor(vertex.first) + parentColor(vertex.second)), vertex.morph);
#ifdef EFFECT_SUN
  float parentLight =
      0.5 * (signedSunlight(parentNormal(vertex.first), towardsEye) + signedSunlight(parentNormal(vertex.second), towardsEye));
  signedLight = mix(signedLight, parentLight, vertex.morph);
#endif
#endif
  color = ownColor * exposure * tint;
}

// A terrain vertex: place it, and light it. Light is computed here and only its cut-off and the display's curve per pixel: triangles
// are a few pixels large, and software GL pays for every operation on every 4 x 4 block that a triangle touches.
#include "placement.glsl"
#include "projection.glsl"

layout(location = 1) in vec3 vertexNormal;  // of 32767
layout(location = 2) in vec3 vertexColor;   // of 255: (reflectance / kColorScale)^(1 / DISPLAY_GAMMA)

uniform float exposure;  // light on the display per unit of light that soil of reflectance kColorScale sends back, on the same curve
uniform vec3 tint;

#ifdef EFFECT_SUN
#include "sun.glsl"
out float signedLight;

float lightAt(vec3 relative, vec3 normal) {
  PRECISE float light = signedSunlight(normal / 32767.0, -normalize(relative));
  return light;
}
#endif

out vec3 color;  // as the display wants it, in full light
invariant gl_Position;

void main() {
#ifdef MORPH
  // All the way at its parent a vertex has what the parent's own draw has there: on a vertex its bits, between two the middle of what it
  // interpolates, which is light as each of the two shows it, not normals.
  MorphedVertex vertex = morphedVertex(vertexOffset.w);
  vec3 relative = morphedPosition(vertex);
  vec3 parents = 0.5 * (parentColor(vertex.first) + parentColor(vertex.second));
  PRECISE vec3 shown = vertexColor * (1.0 - vertex.morph) + parents * vertex.morph;
#else
  vec3 relative = relativePosition();
  vec3 shown = vertexColor;
#endif
  gl_Position = clipPosition(relative);
#ifdef EFFECT_SUN
  signedLight = lightAt(relative, vertexNormal);
#ifdef MORPH
  vec3 toFirst = vec3(stepsToFirst(vertex)) * stepMeters;
  PRECISE float parentLight =
      0.5 * (lightAt(relative + toFirst, parentNormal(vertex.first)) + lightAt(relative - toFirst, parentNormal(vertex.second)));
  signedLight = vertex.morph == 1.0 ? parentLight : mix(signedLight, parentLight, vertex.morph);
#endif
#endif
  PRECISE vec3 scaled = shown * (exposure * tint);
  color = scaled;
}

#include "depth.glsl"

in vec3 color;
#ifdef EFFECT_SUN
#include "sun.glsl"
in float signedLight;
#endif
layout(location = 0) out vec4 pixel;

void main() {
#ifdef EFFECT_SUN
  // The display's curve is a power, and a power of a product is the product of powers: one pow, not three.
  pixel = vec4(color * pow(lightOf(signedLight), 1.0 / DISPLAY_GAMMA), 1.0);
#else
  pixel = vec4(color, 1.0);
#endif
  writeDepth();
}

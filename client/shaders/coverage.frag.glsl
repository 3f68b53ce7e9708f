// Marks what covers a pixel.
#include "depth.glsl"

uniform float mark;
layout(location = 0) out float pixel;

void main() {
  pixel = mark;
  writeDepth();
}

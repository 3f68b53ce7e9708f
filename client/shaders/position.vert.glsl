// Positions only: the coverage pass, and what the tests capture by transform feedback.
#include "placement.glsl"
#include "projection.glsl"

invariant gl_Position;

void main() {
#ifdef MORPH
  gl_Position = clipPosition(morphedPosition(morphedVertex(vertexOffset.w)));
#else
  gl_Position = clipPosition(relativePosition());
#endif
}

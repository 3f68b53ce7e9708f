// Positions only: the coverage pass, and what the tests capture by transform feedback.
#include "placement.glsl"
#include "projection.glsl"

invariant gl_Position;

void main() { gl_Position = clipPosition(relativePosition()); }

// Where a vertex is, relative to the camera, body axes, metres. One of PLACEMENT_INTEGER, _DOUBLE_FLOAT, _CPU, _FLOAT32 is defined.
// Vertices that two tiles of one level share give the same bits, whichever tile draws them (except with _FLOAT32, the control that
// shows what is gained).

#ifdef PLACEMENT_CPU
layout(location = 3) in vec3 vertexRelative;

vec3 relativePosition() { return vertexRelative; }
#else
layout(location = 0) in uvec4 vertexOffset;  // x, y, z in steps from the tile's origin; w is not 0 on a skirt
uniform float stepMeters;                    // a power of two: multiplying by it is exact

#ifdef PLACEMENT_INTEGER
#include "relative_position.glsl"
uniform ivec3 originMinusCamera;  // in steps; the camera rounded down to the lattice
uniform vec3 cameraRest;          // what was rounded away, in steps, 0..1

vec3 relativePosition() {
  return relativeOnLattice(originMinusCamera, ivec3(vertexOffset.xyz), cameraRest, stepMeters);
}
#endif

#ifdef PLACEMENT_DOUBLE_FLOAT
#include "double_float.glsl"
uniform vec3 originHigh, originLow;  // metres; at most 45 bits, so that origin + offset * step is exact
uniform vec3 cameraHigh, cameraLow;

vec3 relativePosition() {
  PRECISE vec3 offsetMeters = vec3(vertexOffset.xyz) * stepMeters;
  DoubleFloat3 position = addFloat(DoubleFloat3(originHigh, originLow), offsetMeters);
  return subtractPairToFloat(position, DoubleFloat3(cameraHigh, cameraLow));
}
#endif

#ifdef PLACEMENT_FLOAT32
uniform vec3 originHigh;  // metres, rounded to float
uniform vec3 cameraHigh;

vec3 relativePosition() {
  vec3 position = originHigh + vec3(vertexOffset.xyz) * stepMeters;
  return position - cameraHigh;
}
#endif
#endif

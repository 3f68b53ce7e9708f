// Where a vertex is, relative to the camera, body axes, metres. One of PLACEMENT_INTEGER, _DOUBLE_FLOAT, _CPU, _FLOAT32 is defined.
// Vertices that two tiles of one level share give the same bits, whichever tile draws them (except with _FLOAT32, the control that
// shows what is gained). With MORPH also where both have the same share of the way to their parents' surfaces, and, all the way on a
// parent's vertex, the bits that the parent's own draw gives.
layout(location = 0) in uvec4 vertexOffset;  // x, y, z in steps from the tile's origin; w: the place in the grid

#ifdef MORPH
#include "morph.glsl"
#endif

uniform float stepMeters;  // a power of two: multiplying by it is exact

#ifdef PLACEMENT_CPU
layout(location = 3) in vec3 vertexRelative;

vec3 relativePosition() { return vertexRelative; }
#ifdef MORPH
vec3 morphedPosition(MorphedVertex vertex) { return vertexRelative; }
#endif
#else
#ifdef PLACEMENT_INTEGER
#include "relative_position.glsl"
uniform ivec3 originMinusCamera;  // in steps; the camera rounded down to the lattice
uniform vec3 cameraRest;          // what was rounded away, in steps, 0..1

vec3 relativePosition() {
  return relativeOnLattice(originMinusCamera, ivec3(vertexOffset.xyz), cameraRest, stepMeters);
}
#ifdef MORPH
uniform ivec3 cameraOdd;        // the camera on the tile's lattice minus the camera on the parent's, in steps
uniform vec3 parentCameraRest;  // what was rounded away there, in steps of the parent

vec3 morphedPosition(MorphedVertex vertex) {
  ivec3 offsetSteps = ivec3(vertexOffset.xyz);
  return relativeMorphed(originMinusCamera + offsetSteps, stepsToParent(vertex, offsetSteps), vertex.morph, vertex.first == vertex.second,
                         cameraRest, stepMeters, cameraOdd, parentCameraRest);
}
#endif
#endif

#ifdef PLACEMENT_DOUBLE_FLOAT
#include "double_float.glsl"
uniform vec3 originHigh, originLow;  // metres; at most 45 bits, so that origin + offset * step is exact
uniform vec3 cameraHigh, cameraLow;

vec3 positionMinusCamera(DoubleFloat3 origin, vec3 offsetMeters) {
  return subtractPairToFloat(addFloat(origin, offsetMeters), DoubleFloat3(cameraHigh, cameraLow));
}

vec3 relativePosition() {
  PRECISE vec3 offsetMeters = vec3(vertexOffset.xyz) * stepMeters;
  return positionMinusCamera(DoubleFloat3(originHigh, originLow), offsetMeters);
}
#ifdef MORPH
uniform vec3 parentOriginHigh, parentOriginLow;

vec3 morphedPosition(MorphedVertex vertex) {
  if (vertex.morph == 1.0 && vertex.first == vertex.second) {
    PRECISE vec3 offsetMeters = vec3(parentOffset(vertex.first)) * (2.0 * stepMeters);
    return positionMinusCamera(DoubleFloat3(parentOriginHigh, parentOriginLow), offsetMeters);
  }
  PRECISE vec3 way = vec3(stepsToParent(vertex, ivec3(vertexOffset.xyz))) * vertex.morph;
  PRECISE vec3 wayMeters = way * stepMeters;
  PRECISE vec3 position = relativePosition() + wayMeters;
  return position;
}
#endif
#endif

#ifdef PLACEMENT_FLOAT32
uniform vec3 originHigh;  // metres, rounded to float
uniform vec3 cameraHigh;

vec3 relativePosition() {
  vec3 position = originHigh + vec3(vertexOffset.xyz) * stepMeters;
  return position - cameraHigh;
}
#ifdef MORPH
vec3 morphedPosition(MorphedVertex vertex) {
  return relativePosition() + vec3(stepsToParent(vertex, ivec3(vertexOffset.xyz))) * vertex.morph * stepMeters;
}
#endif
#endif
#endif

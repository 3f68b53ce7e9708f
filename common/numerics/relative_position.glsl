// Where a vertex is relative to the camera, by each scheme that keeps more than float's 24 bits of a position; body axes, metres. One source
// for GLSL and C++ (relative_position.h, with the bounds); PRECISE and FUNCTION as in double_float_operations.glsl.

// Lattice integers: the vertex in steps from its tile's origin, the tile's origin in steps from the camera (rounded down to the lattice), and
// what that rounding took away, 0..1 steps. stepMeters is a power of two.
FUNCTION vec3 relativeOnLattice(ivec3 originMinusCamera, ivec3 offsetSteps, vec3 cameraRest, float stepMeters) {
  ivec3 steps = originMinusCamera + offsetSteps;
  PRECISE vec3 fromCamera = vec3(steps) - cameraRest;
  PRECISE vec3 meters = fromCamera * stepMeters;
  return meters;
}

// A tile's index and an offset in it, tiles and offsets each by themselves, as Unreal's large world coordinates do.
FUNCTION vec3 relativeByTilesAndOffsets(ivec3 tile, vec3 offsetMeters, ivec3 cameraTile, vec3 cameraOffsetMeters, float tileMeters) {
  PRECISE vec3 tiles = vec3(tile - cameraTile) * tileMeters;
  PRECISE vec3 offsets = offsetMeters - cameraOffsetMeters;
  PRECISE vec3 meters = tiles + offsets;
  return meters;
}

// The same with the way between the tiles' middles halved between vertex and camera: both are then measured from the border between them,
// which costs nothing where both are near it.
FUNCTION vec3 relativeByHalves(ivec3 tile, vec3 offsetMeters, ivec3 cameraTile, vec3 cameraOffsetMeters, float tileMeters) {
  PRECISE vec3 halfWay = vec3(tile - cameraTile) * (0.5f * tileMeters);
  PRECISE vec3 vertex = offsetMeters + halfWay;
  PRECISE vec3 camera = cameraOffsetMeters - halfWay;
  PRECISE vec3 meters = vertex - camera;
  return meters;
}

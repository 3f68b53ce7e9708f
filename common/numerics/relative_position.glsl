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

// The same between a tile's own surface and its parent's, whose step is twice as long: the vertex in steps from the camera, the way in steps to
// the point of the parent's mesh that it moves to (a sum of two of the parent's vertices, so exact), and the share of it, 0..1. At 0 it gives
// relativeOnLattice's bits. At 1 on a vertex of the parent's it gives those of the parent's own: with the camera on the parent's lattice,
// which is cameraOdd steps below the camera on the tile's, 0 or 1 an axis, and with what that rounding took away in steps of the parent.
FUNCTION vec3 relativeMorphed(ivec3 steps, ivec3 toParent, float morph, bool onParentsVertex, vec3 cameraRest, float stepMeters, ivec3 cameraOdd,
                              vec3 parentCameraRest) {
  if (morph == 1.0f && onParentsVertex)
    return relativeOnLattice((steps + toParent + cameraOdd) >> 1, ivec3(0), parentCameraRest, 2.0f * stepMeters);
  PRECISE vec3 own = vec3(steps) - cameraRest;
  PRECISE vec3 way = vec3(toParent) * morph;
  PRECISE vec3 fromCamera = own + way;
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

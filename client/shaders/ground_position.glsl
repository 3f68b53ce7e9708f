// What a pixel shows, relative to the camera, body axes, metres, from the depth that was left there: near / w, 0 where there is
// nothing. A float holds that depth to 2^-24 of itself at any distance, so a point lies within 2^-23 of its distance along its own ray.
uniform sampler2D groundDepth;
uniform mat3 rays;           // from (x, y, 1), the screen being -1..1, to the point one metre ahead of the camera
uniform vec2 pictureSize;    // pixels
uniform float nearMeters;

float depthAt(vec2 pixelCentre) {
  bool inside = all(greaterThan(pixelCentre, vec2(0.0))) && all(lessThan(pixelCentre, pictureSize));
  return inside ? texelFetch(groundDepth, ivec2(pixelCentre), 0).r : 0.0;
}

vec3 groundRelative(vec2 pixelCentre, float depth) {
  // Sky: so far away that nothing can be told of it, but finite.
  return rays * vec3(pixelCentre * (2.0 / pictureSize) - 1.0, 1.0) * (nearMeters / max(depth, 1e-30));
}

// The way on the ground to the next pixel on the axis, from the side where it is shorter: beyond an edge of what is seen lies something else.
vec3 alongGround(vec2 pixelCentre, vec2 axis, vec3 here) {
  vec3 ahead = groundRelative(pixelCentre + axis, depthAt(pixelCentre + axis)) - here;
  vec3 behind = here - groundRelative(pixelCentre - axis, depthAt(pixelCentre - axis));
  return dot(ahead, ahead) < dot(behind, behind) ? ahead : behind;
}

// How long a pixel is on the ground, metres, the way in which it is longer.
float footprintMeters(vec2 pixelCentre, vec3 here) {
  vec3 across = alongGround(pixelCentre, vec2(1.0, 0.0), here), up = alongGround(pixelCentre, vec2(0.0, 1.0), here);
  return sqrt(max(dot(across, across), dot(up, up)));
}

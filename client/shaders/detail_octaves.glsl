// Where the ground lies in every octave of its texture. The camera's own place in each, exact, comes from the CPU
// (common/numerics/octave_coordinates.h); only what lies between camera and ground is added here, so that the error grows with the
// distance from the camera, as the pixel does, and not with that from the body's centre.
uniform vec4 octaves[OCTAVE_COUNT];       // xyz: the camera in its cell, 0..1; w: 1 / wavelength, per metre
uniform ivec3 octaveCells[OCTAVE_COUNT];  // its cell, modulo 2^32

struct OctavePlace {
  ivec3 cell;
  vec3 at;  // 0..1 in the cell
};

OctavePlace octavePlace(int octave, vec3 relative) {
  PRECISE vec3 place = octaves[octave].xyz + relative * octaves[octave].w;
  vec3 whole = floor(place);
  return OctavePlace(octaveCells[octave] + ivec3(whole), place - whole);
}

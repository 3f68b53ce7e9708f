// The effect "detail": what the ground looks like below the mesh, as a factor on the colour that is there. Three octaves at a time, of
// wavelengths from a few pixels up: they fade in below and out above as the pixel's size on the ground changes, so that nothing appears at
// once, nothing shimmers and no scale is ever the last.
#include "ground_position.glsl"
#include "octave_noise.glsl"
#include "detail_octaves.glsl"
#ifdef EFFECT_SUN
uniform vec3 towardsSun;
#endif
uniform vec3 cameraBody;                     // float is enough for the direction up, and for whose ground it is
uniform float reachMeters;                   // of this body; ground farther from its centre is another's
uniform float finestPixels;                 // a wavelength below is not shown
uniform int firstExponent;                   // octave 0 has a wavelength of 2^firstExponent metres
uniform float octaveSlopes[OCTAVE_COUNT];    // of its relief
uniform float octaveMottles[OCTAVE_COUNT];   // of its reflectance, a share

layout(location = 0) out vec4 halfFactor;  // blended as 2 x this x what is there

const int kOctavesShown = 3;

void main() {
  float depth = depthAt(gl_FragCoord.xy);
  if (depth <= 0.0) discard;
  vec3 relative = groundRelative(gl_FragCoord.xy, depth);
  if (length(cameraBody + relative) > reachMeters) discard;
  float scale = log2(footprintMeters(gl_FragCoord.xy, relative) * finestPixels) - float(firstExponent);
  if (!(scale < float(OCTAVE_COUNT))) discard;

  int finest = max(int(floor(scale)) + 1, 0);
  float fade = clamp(float(finest) - scale, 0.0, 1.0);
  float mottle = 0.0;
  vec3 slope = vec3(0.0);
  for (int i = 0; i < kOctavesShown; ++i) {
    int octave = finest + i;
    if (octave >= OCTAVE_COUNT) break;
    OctavePlace place = octavePlace(octave, relative);
    float share = i == 0 ? fade : i == kOctavesShown - 1 ? 1.0 - fade : 1.0;
    vec4 noise = octaveNoise(place.cell, place.at, uint(octave + firstExponent) * 0x632BE59Bu) * share;
    mottle += noise.x * octaveMottles[octave];
    slope += noise.yzw * octaveSlopes[octave];
  }
  float factor = 1.0 + mottle;
#ifdef EFFECT_SUN
  vec3 up = normalize(cameraBody + relative);
  float height = dot(up, towardsSun);
  // Of the slope only what lies along the ground turns it towards the sun or away. Low light shows more, within reason.
  float lightChange = -dot(slope, towardsSun - up * height) / max(height, 0.25);
  factor *= max(1.0 + lightChange, 0.15);
#endif
  halfFactor = vec4(vec3(0.5 * pow(factor, 1.0 / DISPLAY_GAMMA)), 1.0);
}

#pragma once
// How far the ground's texture moves against the ground: a texel of the Moon's ground is marked and followed while the
// camera creeps sideways. In every frame the pixel that shows it is asked for its texture coordinate, as the shaders
// compute it, and for the point of the drawn triangles that lies there, in double; what the two differ by is what the
// texture swims. GL thread only; needs a current context.

#include "common/result.h"
#include "tests/support/tile_source.h"

namespace terrane::test {

enum class TextureCoordinates {
  ByOctave,  ///< as the effect "detail" has them (client/shaders/detail_octaves.glsl)
  Float32,   ///< the position in the body, in float: the control
};

struct SwimSettings {
  double heightMeters = 0.5;  ///< of the camera above the ground
  double pitchDegrees = -40;
  int frames = 100;
  double pixelsPerFrame = 0.3;  ///< that the marked texel moves, about
  int widthPixels = 640, heightPixels = 360;
  double errorPixels = 2;
  TextureCoordinates coordinates = TextureCoordinates::ByOctave;
};

struct Swim {
  int frames = 0;  ///< in which the texel was seen
  int levelChanges = 0;
  double worstPixels = 0, medianPixels = 0;
  double wavelengthMeters = 0;  ///< of the octave that was asked, some four pixels
};

/// Builds the tiles that it needs. Errors: Unsupported ("shader", "framebuffer").
Result<Swim> measureSwim(TileSource& moon, const SwimSettings& settings);

}  // namespace terrane::test

// The loops of a tile build, built for: x86-64-v3 (AVX2). The flags are in CMakeLists.txt.

#define kTileLoops tileLoopsV3
#include "tests/accuracy/tile_build/tile_loops.inl"

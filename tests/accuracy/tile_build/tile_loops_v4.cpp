// The loops of a tile build, built for: x86-64-v4 (AVX-512). The flags are in CMakeLists.txt.

#define kTileLoops tileLoopsV4
#include "tests/accuracy/tile_build/tile_loops.inl"

// The loops of a tile build, built for: any x86-64 (or other) CPU. The flags are in CMakeLists.txt.

#define kTileLoops tileLoopsDefault
#include "tests/accuracy/tile_build/tile_loops.inl"

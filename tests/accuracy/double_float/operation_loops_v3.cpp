// Operations in loops, built for: x86-64-v3 (AVX2 and FMA). The flags are in CMakeLists.txt.

#define kOperationLoop operationLoopV3
#include "tests/accuracy/double_float/operation_loops.inl"

// Operations in loops, built for: the oldest x86-64, or another machine. The flags are in CMakeLists.txt.

#define kOperationLoop operationLoopDefault
#include "tests/accuracy/double_float/operation_loops.inl"

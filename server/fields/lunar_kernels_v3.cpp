// The lunar kernels, built for: x86-64-v3 (AVX2). The flags are in server/CMakeLists.txt.

#include "common/numerics/strict_math.h"
#include "server/fields/far_expansion.h"

namespace terrane::lunar {

#define kEvaluate evaluateBlockV3
#include "server/fields/lunar_kernels.inl"

}  // namespace terrane::lunar

// The lunar kernels, built for: x86-64-v4 (AVX-512). The flags are in server/CMakeLists.txt.

#include "common/numerics/strict_math.h"
#include "server/fields/far_expansion.h"

namespace terrane::lunar {

#define kEvaluate evaluateBlockV4
#include "server/fields/lunar_kernels.inl"

}  // namespace terrane::lunar

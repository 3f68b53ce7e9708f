// The lunar kernels, built for: Any x86-64 (or other) CPU. The flags are in server/CMakeLists.txt.

#include "common/numerics/strict_math.h"
#include "server/fields/far_expansion.h"

namespace terrane::lunar {

#define kEvaluate evaluateBlockDefault
#include "server/fields/lunar_kernels.inl"

}  // namespace terrane::lunar

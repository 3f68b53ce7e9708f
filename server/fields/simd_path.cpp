// Which kernels this CPU can run.

#include <fmt/format.h>

#include "server/fields/height_field.h"

namespace terrane {

bool simdPathSupported(SimdPath path) noexcept {
  switch (path) {
    case SimdPath::Default:
      return true;
#if defined(__x86_64__)
    case SimdPath::V3:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
    case SimdPath::V4:
      return simdPathSupported(SimdPath::V3) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
    case SimdPath::V3:
    case SimdPath::V4:
      return false;
#endif
  }
  return false;
}

SimdPath bestSimdPath() noexcept {
  if (simdPathSupported(SimdPath::V4)) return SimdPath::V4;
  if (simdPathSupported(SimdPath::V3)) return SimdPath::V3;
  return SimdPath::Default;
}

Result<SimdPath> parseSimdPath(std::string_view text) {
  if (text == "default") return SimdPath::Default;
  if (text == "v3") return SimdPath::V3;
  if (text == "v4") return SimdPath::V4;
  return makeError(ErrorKind::InvalidArgument, "--simd", fmt::format("\"{}\" is none of default, v3, v4", text));
}

}  // namespace terrane

#pragma once
// Four numbers side by side. GCC and Clang make vector instructions of them on every machine that has some, with the
// same results on all: whole numbers, and single operations of IEEE floats. Private to proto.

#include <cstdint>
#include <cstring>

#include "common/numerics/strict_math.h"

namespace terrane {

using Int4 = std::int32_t __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));

inline Int4 load4(const std::int32_t* from) noexcept {
  Int4 loaded;
  std::memcpy(&loaded, from, sizeof loaded);
  return loaded;
}
template <class T>
void store4(T* to, Int4 values) noexcept {
  static_assert(sizeof(T) == 4);
  std::memcpy(to, &values, sizeof values);
}

inline Int4 all4(std::int32_t value) noexcept { return Int4{value, value, value, value}; }

/// Of a comparison, whose numbers are 0 or -1: a where it holds, b elsewhere.
inline Int4 choose(Int4 holds, Int4 a, Int4 b) noexcept { return (holds & a) | (~holds & b); }
inline Int4 magnitude(Int4 x) noexcept {
  const Int4 sign = x >> 31;
  return (x ^ sign) - sign;
}

}  // namespace terrane

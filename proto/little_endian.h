#pragma once
// Numbers as Draco's streams hold them. Private to proto. Thread-safe.

#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace terrane {

/// All bytes of value, which the caller has room for even where it keeps fewer.
template <class T>
void putLittleEndian(std::uint8_t* out, T value) noexcept {
  static_assert(std::is_unsigned_v<T>);
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(out, &value, sizeof value);
  } else {
    for (std::size_t byte = 0; byte < sizeof value; ++byte) out[byte] = static_cast<std::uint8_t>(value >> (8 * byte));
  }
}

template <class T>
void appendLittleEndian(T value, std::vector<std::uint8_t>& out) {
  const auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t byte = 0; byte < sizeof(T); ++byte) out.push_back(static_cast<std::uint8_t>(bits >> (8 * byte)));
}

/// Seven bits a byte, lowest first; the eighth says that more follow.
inline void appendVarint(std::uint64_t value, std::vector<std::uint8_t>& out) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

}  // namespace terrane

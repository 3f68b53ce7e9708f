#pragma once
// Numbers as Draco's streams hold them, at the end of some bytes. Private to proto.

#include <cstdint>
#include <type_traits>
#include <vector>

namespace terrane {

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

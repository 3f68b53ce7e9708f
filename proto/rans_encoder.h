#pragma once
// Range asymmetric numeral systems as Draco's streams have them: each symbol, last to first, is pushed onto a state of
// up to 30 bits, which hands its low bytes to the stream whenever it would overflow. One state waits for its own
// multiplications; streams that have nothing to do with each other are coded side by side. Private to proto.
// Thread-safe: no shared state.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace terrane {

/// A symbol's place in [0, 2^precisionBits).
struct RansSymbol {
  std::uint64_t reciprocal = 0;  ///< see ransSymbol
  std::uint32_t probability = 0, cumulative = 0;
};

/// With 2^50 / probability, rounded up: (state x reciprocal) / 2^50 is state / probability, rounded down, for states
/// below 2^10 probability, since each product exceeds the true one by less than state x probability / 2^50 of a
/// quotient's 1 / probability: exact up to 2^20 of precision.
constexpr RansSymbol ransSymbol(std::uint32_t probability, std::uint32_t cumulative) noexcept {
  constexpr std::uint64_t kOne = std::uint64_t{1} << 50;
  return {(kOne + probability - 1) / probability, probability, cumulative};
}

/// What is coded: symbols[i] stands for table[rankOfSymbol[symbols[i]]]. Views; keeps its bytes' memory.
struct RansStream {
  std::span<const std::uint32_t> symbols;
  const std::uint32_t* rankOfSymbol = nullptr;
  const RansSymbol* table = nullptr;
  int precisionBits = 12;  ///< 12 .. 20
  std::vector<std::uint8_t> bytes;
  std::size_t byteCount = 0;  ///< of bytes
};

/// At most three. Those without symbols are left out, with no bytes.
void encodeStreams(std::span<RansStream* const> streams);

}  // namespace terrane

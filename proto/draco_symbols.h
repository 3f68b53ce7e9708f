#pragma once
// The entropy-coded symbols and flags of a Draco stream, version 2.2, as libdraco 1.5 reads them: rANS with a table of
// probabilities, raw (every symbol) or tagged (the bit length of every entry; the bits follow). Bytes that libdraco
// would refuse, and some that no encoder writes, are refused: who asks then asks libdraco. Private to proto.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "proto/draco_bytes.h"

namespace terrane {

/// Reads symbols; its tables are reused from one attribute to the next. Not thread-safe.
class DracoSymbols {
 public:
  /// As many as out holds, `components` an entry. False: out is anything.
  bool read(DracoBytes& bytes, std::size_t components, std::span<std::uint32_t> out);

 private:
  struct Symbol {
    std::uint32_t cumulative;  ///< of all that come before
    std::uint32_t probability;
    std::uint32_t value;
  };

  bool readTable(DracoBytes& bytes, int precisionBits);
  void fillSlots(int precisionBits);
  /// Decodes what follows the table into as many symbols as out holds.
  template <class T>
  bool readCoded(DracoBytes& bytes, int precisionBits, std::span<T> out) const;
  template <bool kFineSlots, class T>
  bool decode(const std::uint8_t* first, const std::uint8_t* end, int precisionBits, std::span<T> out) const;
  bool readTagged(DracoBytes& bytes, std::size_t components, std::span<std::uint32_t> out);
  bool readRaw(DracoBytes& bytes, std::span<std::uint32_t> out);

  std::vector<Symbol> symbols_;       ///< of probability above zero; one more that ends the last
  std::vector<std::uint16_t> slots_;  ///< where the search for a symbol begins, by the highest bits of its place
  std::vector<std::uint8_t> tags_;
};

/// Flags of one probability (libdraco's RAnsBitDecoder). Bytes that end too soon give zeros, as they do there.
class DracoFlags {
 public:
  bool begin(DracoBytes& bytes);
  bool next() noexcept {
    if (state_ < kBase && left_ > 0) state_ = state_ << 8 | first_[--left_];
    const std::uint32_t quotient = state_ >> 8, rest = state_ & 0xFF;
    const std::uint32_t ones = quotient * probabilityOfOne_;
    const bool flag = rest < probabilityOfOne_;
    state_ = flag ? ones + rest : state_ - ones - probabilityOfOne_;
    return flag;
  }

 private:
  static constexpr std::uint32_t kBase = 4096;
  const std::uint8_t* first_ = nullptr;
  std::uint32_t left_ = 0, state_ = kBase, probabilityOfOne_ = 0;
};

}  // namespace terrane

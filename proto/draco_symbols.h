#pragma once
// The entropy-coded symbols and flags of a Draco stream, version 2.2, as libdraco 1.5 reads them: rANS with a table of
// probabilities, raw (every symbol) or tagged (the bit length of every entry; the bits follow). Bytes that libdraco
// would refuse, and some that no encoder writes, are refused: who asks then asks libdraco. Private to proto.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "proto/draco_bytes.h"

namespace terrane {

/// Values and their probabilities, in parts of 2^precisionBits.
class DracoSymbolTable {
 public:
  struct Symbol {
    std::uint32_t cumulative;  ///< of all that come before
    std::uint32_t probability;
    std::uint32_t value;
  };
  /// A place within a symbol's share, of tables of kDirectBits.
  struct Place {
    std::uint32_t value;
    std::uint16_t probability, within;
  };
  /// The least precision that there is, and by far the most frequent one.
  static constexpr int kDirectBits = 12;
  /// A slot stands for several places: a symbol is searched for from the one that its slot's first place belongs to.
  static constexpr int kSlotBits = 13;

  bool read(DracoBytes& bytes, int precisionBits);

  int precisionBits() const noexcept { return precisionBits_; }
  std::uint32_t greatestValue() const noexcept { return symbols_[symbols_.size() - 2].value; }
  const Place* places() const noexcept { return places_.data(); }
  const Symbol* symbols() const noexcept { return symbols_.data(); }
  const std::uint16_t* slots() const noexcept { return slots_.data(); }

 private:
  void fillPlaces();
  void fillSlots();

  int precisionBits_ = 0;
  std::vector<Symbol> symbols_;  ///< of probability above zero; one more that ends the last
  std::vector<Place> places_;    ///< of a direct table
  std::vector<std::uint16_t> slots_;
};

/// Symbols of a table, one after the other (rANS). Cheap to copy.
template <bool kDirect>
class DracoCodedSymbols {
 public:
  /// The coder's data. What lies up to four bytes before them may be read, but not used.
  DracoCodedSymbols(const DracoSymbolTable& table, std::span<const std::uint8_t> coded, std::uint32_t state)
      : places_(table.places()),
        symbols_(table.symbols()),
        slots_(table.slots()),
        precisionBits_(kDirect ? DracoSymbolTable::kDirectBits : table.precisionBits()),
        state_(state),
        first_(coded.data()),
        at_(coded.data() + coded.size()) {}

  std::uint32_t next() noexcept {
    // Up to three bytes, the last first: the state is never below 4.
    const std::uint32_t base = 4u << bits();
    const unsigned need = (state_ < base) + (state_ < base >> 8) + (!kDirect && state_ < base >> 16);
    std::uint32_t word = 0;
    std::memcpy(&word, at_ - sizeof(word), sizeof(word));
    state_ = state_ << (8 * need) | static_cast<std::uint32_t>(static_cast<std::uint64_t>(word) >> (32 - 8 * need));
    at_ -= need;
    if (at_ < first_) [[unlikely]] {
      at_ = first_;
      cut_ = true;
    }
    const std::uint32_t place = state_ & ((1u << bits()) - 1);
    if constexpr (kDirect) {
      const DracoSymbolTable::Place& symbol = places_[place];
      state_ = (state_ >> bits()) * symbol.probability + symbol.within;
      return symbol.value;
    } else {
      const DracoSymbolTable::Symbol* symbol = symbols_ + slots_[place >> (bits() - DracoSymbolTable::kSlotBits)];
      while (place >= symbol[1].cumulative) ++symbol;
      state_ = (state_ >> bits()) * symbol->probability + place - symbol->cumulative;
      return symbol->value;
    }
  }
  template <std::size_t kComponents>
  std::array<std::uint32_t, kComponents> take() noexcept {
    std::array<std::uint32_t, kComponents> entry;
    for (std::uint32_t& symbol : entry) symbol = next();
    return entry;
  }
  /// False if the bytes ended too soon.
  bool ok() const noexcept { return !cut_; }

 private:
  int bits() const noexcept { return kDirect ? DracoSymbolTable::kDirectBits : precisionBits_; }

  const DracoSymbolTable::Place* places_;
  const DracoSymbolTable::Symbol* symbols_;
  const std::uint16_t* slots_;
  int precisionBits_;
  std::uint32_t state_;
  const std::uint8_t *first_, *at_;
  bool cut_ = false;
};

/// Entries whose symbols have as many bits as their tag says.
class DracoTaggedSymbols {
 public:
  /// Bits a symbol, for three of them to lie in one word: 17 are the most that a tile's values need.
  static constexpr std::uint32_t kMostTag = 19;

  /// All tags; what follows the last bits by eight bytes may be read.
  DracoTaggedSymbols(const std::uint8_t* tags, const std::uint8_t* bits) : tag_(tags), first_(bits) {}

  template <std::size_t kComponents>
  std::array<std::uint32_t, kComponents> take() noexcept {
    static_assert(7 + kComponents * kMostTag <= 64);
    const unsigned bits = *tag_++;
    std::uint64_t word = 0;
    std::memcpy(&word, first_ + at_ / 8, sizeof(word));
    word >>= at_ % 8;
    at_ += kComponents * bits;
    std::array<std::uint32_t, kComponents> entry;
    for (std::uint32_t& symbol : entry) {
      symbol = static_cast<std::uint32_t>(word) & ((1u << bits) - 1);
      word >>= bits;
    }
    return entry;
  }
  bool ok() const noexcept { return true; }

 private:
  const std::uint8_t *tag_, *first_;
  std::size_t at_ = 0;  ///< in bits
};

/// An attribute's symbols; tables are reused from one attribute to the next. Not thread-safe.
class DracoSymbols {
 public:
  /// Takes them all from bytes; the symbols themselves are decoded as they are read.
  bool begin(DracoBytes& bytes, std::size_t components, std::size_t entries);

  /// Calls read with a reader of the kind that the symbols are of (take and ok, see above), and returns its answer.
  template <class Read>
  bool read(Read&& read) const {
    if (tagged_) return read(DracoTaggedSymbols(tags_.data(), bits_));
    if (table_.precisionBits() == DracoSymbolTable::kDirectBits)
      return read(DracoCodedSymbols<true>(table_, coded_, state_));
    return read(DracoCodedSymbols<false>(table_, coded_, state_));
  }

 private:
  bool beginCoded(DracoBytes& bytes, int precisionBits);
  bool beginTagged(DracoBytes& bytes, std::size_t components, std::size_t entries);

  bool tagged_ = false;
  DracoSymbolTable table_;
  std::span<const std::uint8_t> coded_;
  std::uint32_t state_ = 0;
  std::vector<std::uint8_t> tags_;
  const std::uint8_t* bits_ = nullptr;
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

#pragma once
// Draco's coding of an attribute's symbols, the very bytes of draco::EncodeSymbols in a small part of its time: either
// each symbol by its own probability (raw), or the bit length of each value's greatest component by probability and
// then the bits (tagged), whichever libdraco takes for shorter. Private to proto. Keeps its memory between uses; an
// object belongs to one thread.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "proto/rans_encoder.h"
#include "proto/symbol_probabilities.h"

namespace terrane {

class SymbolEncoder {
 public:
  /// Counts and chooses. symbols: components for each value, at most kMaxCodedSymbols; they must stay until append.
  /// compressionLevel: 0 to 10, libdraco's 10 - speed. False: an incomplete value; a symbol of 32 bits, for which
  /// libdraco has no room; all of 2^18 symbols, which it refuses.
  bool begin(std::span<const std::uint32_t> symbols, int components, int compressionLevel);
  /// What encodeStreams must code between begin and append.
  RansStream& stream() noexcept { return stream_; }
  /// Adds to out what EncodeSymbols would.
  void append(std::vector<std::uint8_t>& out) const;

  bool tagged() const noexcept { return tagged_; }

 private:
  static constexpr std::size_t kTurns = 4;  ///< counters of a symbol, used in turn

  /// The symbols of an alphabet that come, in their order, and how often.
  struct Alphabet {
    std::vector<std::uint32_t> ofSymbol;  ///< rank of each symbol, before that a rare one's frequency; 0 between uses
    std::vector<std::uint32_t> symbols, frequencies;
    void forget();
  };

  std::uint32_t measureValues();
  void countLengths();
  void countSymbols(std::uint32_t joined);
  void listCounted(Alphabet& alphabet) const;
  void makeTable(Alphabet& alphabet, std::uint32_t total, int precisionBits);
  void appendTable(std::vector<std::uint8_t>& out) const;
  void appendBits(std::vector<std::uint8_t>& out) const;

  std::span<const std::uint32_t> symbols_;
  std::size_t components_ = 1;
  bool tagged_ = false;
  std::uint8_t rawBits_ = 0;            ///< which libdraco writes before raw symbols
  std::vector<std::uint32_t> lengths_;  ///< of each value, in bits
  Alphabet lengthAlphabet_, symbolAlphabet_;
  Alphabet* coded_ = nullptr;                                ///< the one of the stream
  std::vector<std::array<std::uint32_t, kTurns>> counters_;  ///< of the lowest symbols
  std::vector<std::uint32_t> rare_;                          ///< the others that come
  std::vector<std::uint64_t> marks_;
  std::vector<std::uint32_t> probabilities_;
  std::vector<RansSymbol> table_;
  ProbabilityScaler scaler_;
  RansStream stream_;
};

/// All of it at once. False: as begin.
bool encodeSymbols(std::span<const std::uint32_t> symbols, int components, int compressionLevel,
                   std::vector<std::uint8_t>& out);

}  // namespace terrane

#include "proto/symbol_encoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>

#include "proto/little_endian.h"
#include "proto/symbol_entropy.h"

namespace terrane {
namespace {

constexpr int kMaxRawBits = 18;
constexpr int kMaxSymbolBits = 31;  ///< libdraco counts bit lengths in a table of 32
/// Symbols below it are counted by counters for each turn; 16 KB of them.
constexpr std::uint32_t kFrequentSymbols = 1024;

/// Of a symbol or value, which takes at least one.
std::uint32_t bitLength(std::uint32_t symbol) noexcept {
  return static_cast<std::uint32_t>(std::bit_width(symbol | 1u));
}

int precisionBitsOf(int symbolBits) noexcept { return std::clamp(3 * symbolBits / 2, 12, 20); }

/// What libdraco reckons a table of probabilities to take: a byte or two for each symbol that comes, a byte for each 64
/// that do not.
std::int64_t tableBits(std::size_t greatest, std::size_t distinct) noexcept {
  const auto all = static_cast<std::int64_t>(greatest), coming = static_cast<std::int64_t>(distinct);
  return 8 * (2 * coming + (all - coming) / 64);
}

/// By how many bits of precision a level of compression differs.
int bitsOfLevel(int compressionLevel) noexcept {
  if (compressionLevel < 4) return -2;
  if (compressionLevel < 6) return -1;
  if (compressionLevel > 9) return 2;
  return compressionLevel > 7 ? 1 : 0;
}

/// bitLength of a number below 2^31 that is not zero, in operations that compilers make vector instructions of: the
/// exponent of the number as a float, without the bit that might round it up to the next.
std::uint32_t lengthByExponent(std::uint32_t number) noexcept {
  constexpr std::uint32_t kFractionBits = 23, kExponentOfHalf = 126;
  const auto rounded = static_cast<float>(static_cast<std::int32_t>(number & ~(number >> 1)));
  return (std::bit_cast<std::uint32_t>(rounded) >> kFractionBits) - kExponentOfHalf;
}

/// Calls call(count), with the usual counts as constants of the compiler's.
template <class Do>
void withConstant(std::size_t count, Do&& call) {
  if (count == 3)
    call(std::integral_constant<std::size_t, 3>());
  else if (count == 2)
    call(std::integral_constant<std::size_t, 2>());
  else
    call(count);
}

/// Calls count(symbol, turn), turn from 0 to kTurns - 1 and again: a counter that the symbol before has just stored is
/// slow to read, so that equal symbols in a row should have several.
template <std::size_t kTurns, class Count>
void countInTurn(std::span<const std::uint32_t> symbols, Count&& count) {
  std::size_t i = 0;
  for (; i + kTurns <= symbols.size(); i += kTurns)
    for (std::size_t turn = 0; turn < kTurns; ++turn) count(symbols[i + turn], turn);
  for (; i < symbols.size(); ++i) count(symbols[i], 0);
}

}  // namespace

void SymbolEncoder::Alphabet::forget() {
  for (const std::uint32_t symbol : symbols) ofSymbol[symbol] = 0;
  symbols.clear();
  frequencies.clear();
}

/// Fills lengths_. Returns all symbols' bits together.
std::uint32_t SymbolEncoder::measureValues() {
  const std::size_t values = symbols_.size() / components_;
  lengths_.resize(values);
  std::uint32_t* length = lengths_.data();
  std::uint32_t all = 0;
  withConstant(components_, [&](auto perValue) {
    const std::uint32_t* symbol = symbols_.data();
    for (std::size_t i = 0; i < values; ++i) {
      std::uint32_t joined = 1;
      for (std::size_t c = 0; c < perValue; ++c) joined |= *symbol++;
      length[i] = joined;
      all |= joined;
    }
  });
  for (std::size_t i = 0; i < values; ++i) length[i] = lengthByExponent(length[i]);
  return all;
}

void SymbolEncoder::countLengths() {
  Alphabet& alphabet = lengthAlphabet_;
  alphabet.forget();
  alphabet.ofSymbol.resize(kMaxSymbolBits + 1);
  counters_.assign(kMaxSymbolBits + 1, {});
  countInTurn<kTurns>(lengths_, [&](std::uint32_t length, std::size_t turn) { ++counters_[length][turn]; });
  listCounted(alphabet);
}

/// joined: all symbols' bits together, so that none is greater.
void SymbolEncoder::countSymbols(std::uint32_t joined) {
  Alphabet& alphabet = symbolAlphabet_;
  alphabet.forget();
  alphabet.ofSymbol.resize(std::max<std::size_t>(alphabet.ofSymbol.size(), joined + 1));
  counters_.assign(std::min(joined + 1, kFrequentSymbols), {});
  // The others are found in the order of their first coming, marked, and listed in their own order.
  rare_.resize(std::min<std::size_t>(symbols_.size(), joined + 1) + 1);
  std::size_t distinct = 0;
  std::uint32_t* ofSymbol = alphabet.ofSymbol.data();
  countInTurn<kTurns>(symbols_,
                      [&, counters = counters_.data(), rare = rare_.data()](std::uint32_t symbol, std::size_t turn) {
                        if (symbol < kFrequentSymbols) {
                          ++counters[symbol][turn];
                        } else {
                          rare[distinct] = symbol;
                          distinct += ofSymbol[symbol]++ == 0 ? 1 : 0;
                        }
                      });
  listCounted(alphabet);
  marks_.assign(joined / 64 + 1, 0);
  for (std::size_t i = 0; i < distinct; ++i) marks_[rare_[i] / 64] |= std::uint64_t{1} << (rare_[i] % 64);
  for (std::uint32_t word = kFrequentSymbols / 64; word < marks_.size(); ++word) {
    for (std::uint64_t marks = marks_[word]; marks != 0; marks &= marks - 1) {
      const std::uint32_t symbol = 64 * word + static_cast<std::uint32_t>(std::countr_zero(marks));
      alphabet.symbols.push_back(symbol);
      alphabet.frequencies.push_back(ofSymbol[symbol]);
    }
  }
}

/// What counters_ have of the lowest symbols.
void SymbolEncoder::listCounted(Alphabet& alphabet) const {
  alphabet.symbols.resize(counters_.size());
  alphabet.frequencies.resize(counters_.size());
  std::size_t distinct = 0;
  for (std::uint32_t symbol = 0; symbol < counters_.size(); ++symbol) {
    const std::array<std::uint32_t, kTurns>& counts = counters_[symbol];
    alphabet.symbols[distinct] = symbol;
    alphabet.frequencies[distinct] = (counts[0] + counts[1]) + (counts[2] + counts[3]);
    distinct += alphabet.frequencies[distinct] != 0 ? 1 : 0;
  }
  alphabet.symbols.resize(distinct);
  alphabet.frequencies.resize(distinct);
}

void SymbolEncoder::makeTable(Alphabet& alphabet, std::uint32_t total, int precisionBits) {
  const std::size_t distinct = alphabet.symbols.size();
  probabilities_.resize(distinct);
  scaler_.scale(alphabet.frequencies, alphabet.symbols.back() + 1 == distinct, precisionBits, probabilities_);
  table_.resize(distinct);
  std::uint32_t cumulative = 0;
  for (std::size_t rank = 0; rank < distinct; ++rank) {
    table_[rank] = ransSymbol(probabilities_[rank], cumulative);
    cumulative += probabilities_[rank];
    alphabet.ofSymbol[alphabet.symbols[rank]] = static_cast<std::uint32_t>(rank);
  }
  coded_ = &alphabet;
  stream_.symbols = std::span<const std::uint32_t>(tagged_ ? lengths_ : symbols_).first(total);
  stream_.rankOfSymbol = alphabet.ofSymbol.data();
  stream_.table = table_.data();
  stream_.precisionBits = precisionBits;
}

bool SymbolEncoder::begin(std::span<const std::uint32_t> symbols, int components, int compressionLevel) {
  symbols_ = symbols;
  components_ = static_cast<std::size_t>(std::max(1, components));
  stream_.symbols = {};
  if (symbols.size() % components_ != 0 || symbols.size() > kMaxCodedSymbols) return false;
  if (symbols.empty()) return true;
  const std::uint32_t joined = measureValues();
  if (bitLength(joined) > kMaxSymbolBits) return false;
  countLengths();
  tagged_ = bitLength(joined) > kMaxRawBits;
  if (!tagged_) {
    countSymbols(joined);
    std::int64_t valueBits = 0;
    for (std::size_t i = 0; i < lengthAlphabet_.symbols.size(); ++i)
      valueBits += static_cast<std::int64_t>(lengthAlphabet_.frequencies[i]) * lengthAlphabet_.symbols[i];
    const std::size_t lengths = lengthAlphabet_.symbols.size(), distinct = symbolAlphabet_.symbols.size();
    const SymbolCounts byLength{lengthAlphabet_.frequencies, static_cast<std::uint32_t>(lengths_.size()),
                                tableBits(lengths, lengths) + valueBits * static_cast<std::int64_t>(components_)};
    const SymbolCounts bySymbol{symbolAlphabet_.frequencies, static_cast<std::uint32_t>(symbols.size()),
                                tableBits(symbolAlphabet_.symbols.back(), distinct)};
    tagged_ = takesFewerBits(byLength, bySymbol);
  }
  if (tagged_) {
    makeTable(lengthAlphabet_, static_cast<std::uint32_t>(lengths_.size()), precisionBitsOf(5));
  } else {
    const auto distinct = static_cast<std::uint32_t>(symbolAlphabet_.symbols.size());
    if (bitLength(distinct) > kMaxRawBits) return false;
    const int bits = std::clamp(static_cast<int>(bitLength(distinct)) + bitsOfLevel(compressionLevel), 1, kMaxRawBits);
    rawBits_ = static_cast<std::uint8_t>(bits);
    makeTable(symbolAlphabet_, static_cast<std::uint32_t>(symbols.size()), precisionBitsOf(bits));
  }
  return true;
}

/// A probability takes one to three bytes, whose first two bits say how many follow; 3 says how many symbols do not
/// come, up to 64 at once.
void SymbolEncoder::appendTable(std::vector<std::uint8_t>& out) const {
  appendVarint(coded_->symbols.back() + 1, out);
  std::uint32_t next = 0;
  for (std::size_t rank = 0; rank < table_.size(); ++rank) {
    for (std::uint32_t absent = coded_->symbols[rank] - next; absent > 0;) {
      const std::uint32_t run = std::min(absent, 64u);
      out.push_back(static_cast<std::uint8_t>(((run - 1) << 2) | 3));
      absent -= run;
    }
    next = coded_->symbols[rank] + 1;
    const std::uint32_t probability = table_[rank].probability;
    const std::uint32_t more = probability < (1u << 6) ? 0 : probability < (1u << 14) ? 1 : 2;
    const std::uint32_t written = (probability << 2) | more;
    for (std::uint32_t i = 0; i <= more; ++i) out.push_back(static_cast<std::uint8_t>(written >> (8 * i)));
  }
}

/// The values' bits, lowest first, one after the other.
void SymbolEncoder::appendBits(std::vector<std::uint8_t>& out) const {
  std::size_t bits = 0;
  for (const std::uint32_t length : lengths_) bits += length;
  const std::size_t begin = out.size(), byteCount = (bits * components_ + 7) / 8;
  out.resize(begin + byteCount + 8);
  std::uint8_t* to = out.data() + begin;
  std::uint64_t pending = 0;
  std::uint32_t count = 0;
  const auto put = [&](std::uint64_t added, std::uint32_t addedBits) {
    pending |= added << count;
    count += addedBits;
    putLittleEndian(to, pending);  // of which whole bytes stay
    to += count / 8;
    pending >>= count / 8 * 8;
    count %= 8;
  };
  withConstant(components_, [&](auto perValue) {
    constexpr std::uint32_t kMostAtOnce = 56;
    const std::uint32_t* symbol = symbols_.data();
    for (const std::uint32_t length : lengths_) {
      if (perValue * length <= kMostAtOnce) [[likely]] {
        std::uint64_t value = 0;
        for (std::size_t c = 0; c < perValue; ++c) value |= static_cast<std::uint64_t>(symbol[c]) << (c * length);
        put(value, static_cast<std::uint32_t>(perValue * length));
      } else {
        for (std::size_t c = 0; c < perValue; ++c) put(symbol[c], length);
      }
      symbol += perValue;
    }
  });
  out.resize(begin + byteCount);
}

void SymbolEncoder::append(std::vector<std::uint8_t>& out) const {
  if (symbols_.empty()) return;
  out.push_back(tagged_ ? 0 : 1);
  if (!tagged_) out.push_back(rawBits_);
  appendTable(out);
  appendVarint(stream_.byteCount, out);
  out.insert(out.end(), stream_.bytes.begin(), stream_.bytes.begin() + static_cast<std::ptrdiff_t>(stream_.byteCount));
  if (tagged_) appendBits(out);
}

bool encodeSymbols(std::span<const std::uint32_t> symbols, int components, int compressionLevel,
                   std::vector<std::uint8_t>& out) {
  SymbolEncoder encoder;
  if (!encoder.begin(symbols, components, compressionLevel)) return false;
  RansStream* const stream[] = {&encoder.stream()};
  encodeStreams(stream);
  encoder.append(out);
  return true;
}

}  // namespace terrane

#include "proto/draco_symbols.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace terrane {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint8_t kTagged = 0, kRaw = 1;
constexpr int kTagBits = 5;
constexpr int kMostRawBits = 18;
/// Above, a slot stands for several places, and a symbol is searched for from where the slot's first lies.
constexpr int kSlotBits = 13;
constexpr std::size_t kMostSymbols = 1u << kMostRawBits;
/// Bits that one entry's tag may ask for: the values of this project have 17 at most.
constexpr std::uint32_t kMostTag = 32;

constexpr int precisionBitsOf(int symbolBits) { return std::clamp(3 * symbolBits / 2, 12, 20); }

/// The last 1 to 4 bytes of coded data: the coder's state. Shortens end by them.
bool takeState(const std::uint8_t* first, const std::uint8_t*& end, int mostBytes, std::uint32_t& state) {
  if (first == end) return false;
  const int bytes = 1 + (end[-1] >> 6);
  if (bytes > mostBytes || end - first < bytes) return false;
  state = 0;
  for (int i = 0; i < bytes; ++i) state = state << 8 | *--end;
  state &= (1u << (8 * bytes - 2)) - 1;
  return true;
}

std::uint64_t loadWord(const std::uint8_t* at) {
  std::uint64_t word = 0;
  std::memcpy(&word, at, sizeof(word));
  return word;
}

}  // namespace

bool DracoSymbols::read(DracoBytes& bytes, std::size_t components, std::span<std::uint32_t> out) {
  std::uint8_t scheme = 0;
  if (!bytes.take(scheme)) return false;
  if (scheme == kTagged) return readTagged(bytes, components, out);
  return scheme == kRaw && readRaw(bytes, out);
}

bool DracoSymbols::readTable(DracoBytes& bytes, int precisionBits) {
  std::uint32_t count = 0;
  if (!bytes.takeVarint(count) || count > kMostSymbols) return false;
  symbols_.clear();
  const std::uint32_t precision = 1u << precisionBits;
  std::uint32_t sum = 0;
  for (std::uint32_t value = 0; value < count; ++value) {
    std::uint8_t byte = 0;
    if (!bytes.take(byte)) return false;
    std::uint32_t probability = byte >> 2;
    const int more = byte & 3;
    if (more == 3) {  // so many after this one are zero, too
      value += probability;
      if (value >= count) return false;
      continue;
    }
    for (int i = 0; i < more; ++i) {
      if (!bytes.take(byte)) return false;
      probability |= static_cast<std::uint32_t>(byte) << (8 * i + 6);
    }
    if (probability == 0) continue;
    symbols_.push_back({sum, probability, value});
    sum += probability;
    if (sum > precision) return false;
  }
  if (sum != precision || symbols_.size() > UINT16_MAX) return false;
  symbols_.push_back({sum, 0, 0});
  fillSlots(precisionBits);
  return true;
}

void DracoSymbols::fillSlots(int precisionBits) {
  const int slotBits = std::min(precisionBits, kSlotBits);
  const int shift = precisionBits - slotBits;
  slots_.resize(std::size_t{1} << slotBits);
  std::uint16_t* slot = slots_.data();
  for (std::size_t i = 0; i + 1 < symbols_.size(); ++i) {
    // A slot belongs to the symbol that its first place belongs to.
    std::uint16_t* const end = slots_.data() + ((symbols_[i + 1].cumulative + (1u << shift) - 1) >> shift);
    if (slot < end) std::fill(slot, end, static_cast<std::uint16_t>(i));
    slot = std::max(slot, end);
  }
}

template <class T>
bool DracoSymbols::readCoded(DracoBytes& bytes, int precisionBits, std::span<T> out) const {
  std::uint32_t size = 0;
  if (!bytes.takeVarint(size)) return false;
  const std::uint8_t* const first = bytes.data();
  if (!bytes.skip(size)) return false;
  return precisionBits <= kSlotBits ? decode<true>(first, first + size, precisionBits, out)
                                    : decode<false>(first, first + size, precisionBits, out);
}

template <bool kFineSlots, class T>
bool DracoSymbols::decode(const std::uint8_t* first, const std::uint8_t* end, int precisionBits,
                          std::span<T> out) const {
  const std::uint32_t base = 4u << precisionBits, mask = (1u << precisionBits) - 1;
  std::uint32_t state = 0;
  if (!takeState(first, end, 4, state)) return false;
  state += base;
  if (state >> 8 >= base) return false;
  const Symbol* const symbols = symbols_.data();
  const std::uint16_t* const slots = slots_.data();
  const std::uint8_t* at = end;
  for (T& value : out) {
    // Up to three bytes, the last first: the state is never below 4. What lies before the data is the stream's head.
    const unsigned need = (state < base) + (state < base >> 8) + (state < base >> 16);
    std::uint32_t word = 0;
    std::memcpy(&word, at - 4, sizeof(word));
    state = state << (8 * need) | static_cast<std::uint32_t>(static_cast<std::uint64_t>(word) >> (32 - 8 * need));
    at -= need;
    if (at < first) return false;
    const std::uint32_t place = state & mask;
    const Symbol* symbol = symbols + slots[kFineSlots ? place : place >> (precisionBits - kSlotBits)];
    if constexpr (!kFineSlots) {
      while (place >= symbol[1].cumulative) ++symbol;
    }
    value = static_cast<T>(symbol->value);
    state = (state >> precisionBits) * symbol->probability + place - symbol->cumulative;
  }
  return true;
}

bool DracoSymbols::readTagged(DracoBytes& bytes, std::size_t components, std::span<std::uint32_t> out) {
  const int precisionBits = precisionBitsOf(kTagBits);
  if (!readTable(bytes, precisionBits) || symbols_[symbols_.size() - 2].value > kMostTag) return false;
  tags_.resize(out.size() / components);
  if (!readCoded(bytes, precisionBits, std::span(tags_))) return false;
  std::size_t bits = 0;
  for (const std::uint8_t tag : tags_) bits += tag * components;
  const std::uint8_t* const first = bytes.data();
  // After the bits a range follows, so that whole words can be loaded.
  if (!bytes.skip((bits + 7) / 8) || bytes.left() < sizeof(std::uint64_t)) return false;
  std::size_t at = 0;
  std::uint32_t* value = out.data();
  for (const std::uint8_t tag : tags_) {
    const std::uint64_t mask = (std::uint64_t{1} << tag) - 1;
    for (std::size_t c = 0; c < components; ++c, at += tag) {
      *value++ = static_cast<std::uint32_t>(loadWord(first + at / 8) >> (at % 8) & mask);
    }
  }
  return true;
}

bool DracoSymbols::readRaw(DracoBytes& bytes, std::span<std::uint32_t> out) {
  std::uint8_t symbolBits = 0;
  if (!bytes.take(symbolBits) || symbolBits < 1 || symbolBits > kMostRawBits) return false;
  const int precisionBits = precisionBitsOf(symbolBits);
  return readTable(bytes, precisionBits) && readCoded(bytes, precisionBits, out);
}

bool DracoFlags::begin(DracoBytes& bytes) {
  std::uint8_t probabilityOfZero = 0;
  std::uint32_t size = 0;
  if (!bytes.take(probabilityOfZero) || !bytes.takeVarint(size)) return false;
  first_ = bytes.data();
  if (!bytes.skip(size)) return false;
  const std::uint8_t* end = first_ + size;
  if (!takeState(first_, end, 3, state_)) return false;
  state_ += kBase;
  if (state_ >> 8 >= kBase) return false;
  left_ = static_cast<std::uint32_t>(end - first_);
  probabilityOfOne_ = static_cast<std::uint8_t>(256 - probabilityOfZero);
  return true;
}

}  // namespace terrane

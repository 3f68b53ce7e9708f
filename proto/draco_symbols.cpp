#include "proto/draco_symbols.h"

#include <algorithm>
#include <bit>

namespace terrane {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint8_t kTagged = 0, kRaw = 1;
constexpr int kTagBits = 5;
constexpr int kMostRawBits = 18;
constexpr std::size_t kMostSymbols = 1u << kMostRawBits;

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

}  // namespace

bool DracoSymbolTable::read(DracoBytes& bytes, int precisionBits) {
  std::uint32_t count = 0;
  if (!bytes.takeVarint(count) || count > kMostSymbols) return false;
  precisionBits_ = precisionBits;
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
  precisionBits == kDirectBits ? fillPlaces() : fillSlots();
  return true;
}

void DracoSymbolTable::fillPlaces() {
  places_.resize(std::size_t{1} << kDirectBits);
  Place* place = places_.data();
  for (std::size_t i = 0; i + 1 < symbols_.size(); ++i) {
    const auto probability = static_cast<std::uint16_t>(symbols_[i].probability);
    for (std::uint16_t within = 0; within < probability; ++within) *place++ = {symbols_[i].value, probability, within};
  }
}

void DracoSymbolTable::fillSlots() {
  const int shift = precisionBits_ - kSlotBits;
  slots_.resize(std::size_t{1} << kSlotBits);
  std::uint16_t* slot = slots_.data();
  for (std::size_t i = 0; i + 1 < symbols_.size(); ++i) {
    std::uint16_t* const end = slots_.data() + ((symbols_[i + 1].cumulative + (1u << shift) - 1) >> shift);
    if (slot < end) std::fill(slot, end, static_cast<std::uint16_t>(i));
    slot = std::max(slot, end);
  }
}

bool DracoSymbols::begin(DracoBytes& bytes, std::size_t components, std::size_t entries) {
  std::uint8_t scheme = 0, symbolBits = 0;
  if (!bytes.take(scheme)) return false;
  tagged_ = scheme == kTagged;
  if (tagged_) return beginTagged(bytes, components, entries);
  if (scheme != kRaw || !bytes.take(symbolBits) || symbolBits < 1 || symbolBits > kMostRawBits) return false;
  return beginCoded(bytes, precisionBitsOf(symbolBits));
}

bool DracoSymbols::beginCoded(DracoBytes& bytes, int precisionBits) {
  std::uint32_t size = 0;
  if (!table_.read(bytes, precisionBits) || !bytes.takeVarint(size)) return false;
  const std::uint8_t *const first = bytes.data(), *end = first + size;
  if (!bytes.skip(size) || !takeState(first, end, 4, state_)) return false;
  const std::uint32_t base = 4u << precisionBits;
  state_ += base;
  coded_ = {first, end};
  return state_ >> 8 < base;
}

bool DracoSymbols::beginTagged(DracoBytes& bytes, std::size_t components, std::size_t entries) {
  static_assert(precisionBitsOf(kTagBits) == DracoSymbolTable::kDirectBits);
  if (!beginCoded(bytes, DracoSymbolTable::kDirectBits) || table_.greatestValue() > DracoTaggedSymbols::kMostTag)
    return false;
  tags_.resize(entries);
  DracoCodedSymbols<true> tags(table_, coded_, state_);
  std::size_t bits = 0;
  for (std::uint8_t& tag : tags_) {
    tag = static_cast<std::uint8_t>(tags.next());
    bits += tag;
  }
  bits_ = bytes.data();
  // After the bits a range follows, so that whole words can be loaded.
  return tags.ok() && bytes.skip((bits * components + 7) / 8) && bytes.left() >= sizeof(std::uint64_t);
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

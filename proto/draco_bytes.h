#pragma once
// The bytes of a Draco stream, taken from the front with every end checked. Private to proto. Little-endian, as
// libdraco reads them on the machines that it runs on.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace terrane {

class DracoBytes {
 public:
  /// Of a stream from a place on; what lies before stays readable (see DracoSymbols).
  DracoBytes(std::span<const std::uint8_t> stream, std::size_t begin) : stream_(stream), at_(begin) {}

  std::size_t position() const noexcept { return at_; }
  std::size_t left() const noexcept { return stream_.size() - at_; }
  const std::uint8_t* data() const noexcept { return stream_.data() + at_; }
  std::span<const std::uint8_t> since(std::size_t begin) const { return stream_.subspan(begin, at_ - begin); }
  std::span<const std::uint8_t> stream() const noexcept { return stream_; }

  /// All of these return false, and take nothing that matters, where the bytes end too soon.
  template <class T>
  bool take(T& value) {
    if (left() < sizeof(T)) return false;
    std::memcpy(&value, data(), sizeof(T));
    at_ += sizeof(T);
    return true;
  }
  bool skip(std::size_t count) {
    if (left() < count) return false;
    at_ += count;
    return true;
  }
  /// The very bytes that are expected.
  bool match(std::span<const std::uint8_t> expected) {
    if (left() < expected.size() || std::memcmp(data(), expected.data(), expected.size()) != 0) return false;
    at_ += expected.size();
    return true;
  }
  /// Base 128; false too for what does not fit 32 bits.
  bool takeVarint(std::uint32_t& value) {
    std::uint64_t sum = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      std::uint8_t byte = 0;
      if (!take(byte)) return false;
      sum |= static_cast<std::uint64_t>(byte & 0x7Fu) << shift;
      if ((byte & 0x80u) != 0) continue;
      value = static_cast<std::uint32_t>(sum);
      return sum <= 0xFFFFFFFFu;
    }
    return false;
  }

 private:
  std::span<const std::uint8_t> stream_;
  std::size_t at_;
};

}  // namespace terrane

#include "proto/rans_bits.h"

#include <algorithm>
#include <array>

#include "common/numerics/strict_math.h"
#include "proto/little_endian.h"
#include "proto/rans_encoder.h"

namespace terrane {
namespace {

constexpr std::uint32_t kPrecision = 256, kLeastState = 4096;
constexpr double kHalf = 0.5;  ///< added before cutting, as libdraco rounds

/// Of 256; neither 0 nor all.
std::uint32_t probabilityOfZero(std::span<const std::uint8_t> bits) {
  const auto zeros = static_cast<double>(std::ranges::count(bits, 0));
  const double total = std::max<double>(1.0, static_cast<double>(bits.size()));
  return std::clamp(static_cast<std::uint32_t>(zeros / total * kPrecision + kHalf), 1u, 255u);
}

}  // namespace

void appendRansBits(std::span<const std::uint8_t> bits, std::vector<std::uint8_t>& out) {
  const std::uint32_t zero = probabilityOfZero(bits);
  const std::array<RansSymbol, 2> table{ransSymbol(zero, kPrecision - zero), ransSymbol(kPrecision - zero, 0)};
  out.push_back(static_cast<std::uint8_t>(zero));
  thread_local std::vector<std::uint8_t> bytes;
  bytes.clear();
  std::uint64_t state = kLeastState;
  for (std::size_t i = bits.size(); i-- > 0;) {
    const RansSymbol& symbol = table[bits[i]];
    if (state >= std::uint64_t{kLeastState} * symbol.probability) {
      bytes.push_back(static_cast<std::uint8_t>(state));
      state >>= 8;
    }
    const std::uint64_t quotient = (state * symbol.reciprocal) >> 50;
    state += symbol.cumulative + quotient * (kPrecision - symbol.probability);
  }
  const auto rest = static_cast<std::uint32_t>(state) - kLeastState;
  const std::uint32_t more = rest < (1u << 6) ? 0 : rest < (1u << 14) ? 1 : 2;
  for (std::uint32_t byte = 0, written = rest | (more << (6 + 8 * more)); byte <= more; ++byte)
    bytes.push_back(static_cast<std::uint8_t>(written >> (8 * byte)));
  appendVarint(bytes.size(), out);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace terrane

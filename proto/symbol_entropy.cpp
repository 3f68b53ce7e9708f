#include "proto/symbol_entropy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "common/numerics/strict_math.h"

namespace terrane {
namespace {

__extension__ using Wide = unsigned __int128;
__extension__ using SignedWide = __int128;

constexpr int kLogBits = 40;   ///< binary places of a fixed logarithm
constexpr int kTermBits = 32;  ///< of a fixed sum
constexpr std::uint32_t kTabled = 2048;

/// log2(n), rounded down to kLogBits places: each squaring of the mantissa brings the next one to its front. Rounding a
/// square down by 2^-63 of it takes at most 2^-62 from the logarithm at the first place and half as much at each
/// further one, so that the result is short by less than 2^-40 + 2^-61.
std::uint64_t fixedLog2(std::uint32_t n) noexcept {
  const int exponent = std::bit_width(n) - 1;
  std::uint64_t mantissa = static_cast<std::uint64_t>(n) << (63 - exponent);
  auto log = static_cast<std::uint64_t>(exponent);
  for (int place = 0; place < kLogBits; ++place) {
    const Wide square = static_cast<Wide>(mantissa) * mantissa;
    const auto carry = static_cast<unsigned>(square >> 127);
    mantissa = static_cast<std::uint64_t>(square >> (63 + carry));
    log = 2 * log + carry;
  }
  return log;
}

/// n log2(n) in units of 2^-kTermBits, short by less than 1 + n 2^-7.
std::uint64_t fixedTerm(std::uint32_t n) noexcept {
  return static_cast<std::uint64_t>((static_cast<Wide>(n) * fixedLog2(n)) >> (kLogBits - kTermBits));
}

const std::array<std::uint64_t, kTabled>& tabledTerms() {
  static const std::array<std::uint64_t, kTabled> terms = [] {
    std::array<std::uint64_t, kTabled> all{};
    for (std::uint32_t n = 1; n < kTabled; ++n) all[n] = fixedTerm(n);
    return all;
  }();
  return terms;
}

/// The upper half of a square; short by less than three units of its last place.
Wide squareHigh(Wide x) noexcept {
  const auto high = static_cast<std::uint64_t>(x >> 64), low = static_cast<std::uint64_t>(x);
  const Wide middle = static_cast<Wide>(high) * low;
  return static_cast<Wide>(high) * high + (middle >> 63);
}

std::int64_t wholeBits(std::int64_t fixed) noexcept { return fixed >> kTermBits; }

}  // namespace

double roundedLog2(double x) {
  constexpr int kPlaces = 75;
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);  // in [1/2, 1)
  Wide mantissa = static_cast<Wide>(static_cast<std::uint64_t>(std::ldexp(fraction, 53))) << 75;
  Wide places = 0;
  for (int place = 0; place < kPlaces; ++place) {
    const Wide square = squareHigh(mantissa);  // in [2^126, 2^128), where one is 2^126
    const auto carry = static_cast<unsigned>(square >> 127);
    mantissa = carry != 0 ? square : square << 1;
    places = 2 * places + carry;
  }
  const SignedWide log = (static_cast<SignedWide>(exponent - 1) << kPlaces) + static_cast<SignedWide>(places);
  return std::ldexp(static_cast<double>(log), -kPlaces);
}

std::int64_t entropyBitsInDouble(std::span<const std::uint32_t> frequencies, std::uint32_t total) {
  double sum = 0;
  for (const std::uint32_t frequency : frequencies)
    sum += frequency * roundedLog2(static_cast<double>(frequency) / total);
  return static_cast<std::int64_t>(-sum);
}

EntropyBounds entropyBounds(std::span<const std::uint32_t> frequencies, std::uint32_t total) {
  const std::array<std::uint64_t, kTabled>& tabled = tabledTerms();
  const std::uint64_t whole = fixedTerm(total);
  std::uint64_t parts = 0;
  for (const std::uint32_t frequency : frequencies)
    parts += frequency < kTabled ? tabled[frequency] : fixedTerm(frequency);
  const auto entropy = static_cast<std::int64_t>(whole - parts);
  // Each term is short by one unit and n 2^-7 of them, the terms of the parts together by one each and total 2^-7.
  const std::uint64_t terms = frequencies.size() + 2;
  const std::uint64_t fixedSlack = terms + total / 64;
  // libdraco's: a term and a partial sum are each off by at most 2^-52 of all.
  const std::uint64_t doubleSlack = 2 + ((2 * terms * (whole >> 20)) >> 32);
  const auto slack = static_cast<std::int64_t>(fixedSlack + doubleSlack);
  return {std::max<std::int64_t>(0, entropy - slack), std::max<std::int64_t>(0, entropy + slack)};
}

bool takesFewerBits(const SymbolCounts& a, const SymbolCounts& b) {
  const EntropyBounds ofA = entropyBounds(a.frequencies, a.total), ofB = entropyBounds(b.frequencies, b.total);
  if (wholeBits(ofA.greatest) + a.bitsBesides < wholeBits(ofB.least) + b.bitsBesides) return true;
  if (wholeBits(ofA.least) + a.bitsBesides >= wholeBits(ofB.greatest) + b.bitsBesides) return false;
  return entropyBitsInDouble(a.frequencies, a.total) + a.bitsBesides <
         entropyBitsInDouble(b.frequencies, b.total) + b.bitsBesides;
}

}  // namespace terrane

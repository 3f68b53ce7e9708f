#pragma once
// How many bits symbols take at their entropy, rounded down: what libdraco's symbol coder chooses its way of writing
// by. In fixed point, so that no machine's logarithm decides a byte. Private to proto. Thread-safe.

#include <cstddef>
#include <cstdint>
#include <span>

namespace terrane {

/// More frequencies or symbols overflow the sums.
inline constexpr std::size_t kMaxCodedSymbols = std::size_t{1} << 26;

/// How often each symbol comes, none of them zero, in the order of the symbols; their sum; and what the way of writing
/// that they belong to takes besides.
struct SymbolCounts {
  std::span<const std::uint32_t> frequencies;
  std::uint32_t total = 0;
  std::int64_t bitsBesides = 0;
};

/// Whether a takes fewer bits than b by libdraco's sums. Those are in double, one term after the other, off by some
/// units of their last place; where that could decide, they are repeated with logarithms rounded to nearest, so that
/// the answer can differ only where libdraco's own depends on the machine's logarithm.
bool takesFewerBits(const SymbolCounts& a, const SymbolCounts& b);

/// floor(sum of frequency x log2(total / frequency)) as libdraco sums it.
std::int64_t entropyBitsInDouble(std::span<const std::uint32_t> frequencies, std::uint32_t total);

/// Bounds of the same in units of 2^-32 bits, wide enough for libdraco's rounding too.
struct EntropyBounds {
  std::int64_t least = 0, greatest = 0;
};
EntropyBounds entropyBounds(std::span<const std::uint32_t> frequencies, std::uint32_t total);

/// log2(x) of x in (0, 1], rounded to nearest, but for ties of the 75th binary place.
double roundedLog2(double x);

}  // namespace terrane

#pragma once
// The hash behind everything that fields place at random: integers alone, so that no last bit depends on a library or a
// CPU. Thread-safe.

#include <cstdint>

namespace terrane {

/// A bijection (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators": SplitMix64).
constexpr std::uint64_t mixHash(std::uint64_t h) noexcept {
  h += 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
  return h ^ (h >> 31);
}

/// In [0, 1).
constexpr double hashUnit(std::uint64_t h) noexcept { return static_cast<double>(h >> 11) * 0x1p-53; }

}  // namespace terrane

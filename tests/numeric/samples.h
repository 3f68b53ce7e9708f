#pragma once
// What the numeric tests share: equality to the bit, and a random source that prints its seed.

#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>
#include <iostream>
#include <random>

namespace terrane::test {

inline bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
inline bool sameBits(const glm::dvec3& a, const glm::dvec3& b) {
  return sameBits(a.x, b.x) && sameBits(a.y, b.y) && sameBits(a.z, b.z);
}

/// Prints its seed.
inline std::mt19937_64 seededRandom(std::uint64_t seed) {
  std::cout << "seed " << seed << '\n';
  return std::mt19937_64(seed);
}

}  // namespace terrane::test

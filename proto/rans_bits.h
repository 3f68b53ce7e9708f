#pragma once
// Draco's coding of single bits by one probability, the bytes of draco::RAnsBitEncoder. Private to proto. Thread-safe:
// no shared state.

#include <cstdint>
#include <span>
#include <vector>

namespace terrane {

/// Adds the coded bits to out; each of bits is 0 or 1.
void appendRansBits(std::span<const std::uint8_t> bits, std::vector<std::uint8_t>& out);

}  // namespace terrane

#pragma once
// Whole numbers of a mesh as the symbols that a Draco stream holds of them: predicted by earlier entries, the rest
// wrapped into the range of all values, its sign in the lowest bit. Private to proto. Thread-safe: no shared state.

#include <cstdint>
#include <span>
#include <vector>

#include "proto/entry_order.h"

namespace terrane {

/// How an entry is predicted, as Draco numbers it.
enum class IntegerPrediction : std::uint8_t {
  Difference = 0,          ///< by the one before
  Parallelogram = 1,       ///< by the one of its own triangle
  MultiParallelogram = 4,  ///< by the mean of all around it, cut towards zero
};

/// Of all values, which the stream holds too.
struct ValueRange {
  std::int32_t least = 0, greatest = 0;
};

struct ResidualScratch {
  std::vector<std::int32_t> values;  ///< in the order of entries, four to each
};

/// source: components (1 or 3) for each vertex. symbols: as many, in the order of entries.
ValueRange residualSymbols(std::span<const std::uint16_t> source, int components, const EntryOrder& order,
                           IntegerPrediction prediction, ResidualScratch& scratch, std::vector<std::uint32_t>& symbols);
ValueRange residualSymbols(std::span<const std::uint8_t> source, int components, const EntryOrder& order,
                           IntegerPrediction prediction, ResidualScratch& scratch, std::vector<std::uint32_t>& symbols);

}  // namespace terrane

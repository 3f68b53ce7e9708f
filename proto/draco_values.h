#pragma once
// The attributes' values of a Draco stream whose connectivity is known. Private to proto. Thread-safe.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/draco_connectivity.h"
#include "proto/draco_symbols.h"

namespace terrane {

/// Working memory, reused from tile to tile: 24 bytes a triangle, and the entropy coder's tables (under a megabyte). Of
/// one thread at a time.
struct DracoScratch {
  DracoSymbols symbols;
  std::vector<double> triangleNormals;
};

/// The mesh that decodeDraco gives for these bytes, bit for bit; or nothing, which says no more than that this does not
/// read them: prediction methods and quantisations other than Terrane's, or damage. bytes begins with the
/// connectivity's head.
std::optional<TileMesh> decodeDracoValues(const DracoConnectivity& connectivity, std::span<const std::uint8_t> bytes,
                                          DracoScratch& scratch);

/// The same, which also keeps the grid indices for streams to come.
std::optional<TileMesh> learnDracoGrid(DracoConnectivity& connectivity, std::span<const std::uint8_t> bytes,
                                       DracoScratch& scratch);

}  // namespace terrane

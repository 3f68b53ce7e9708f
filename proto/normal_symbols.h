#pragma once
// A mesh's normals as the symbols that a Draco stream holds of them: points of the octahedron, predicted by the one
// before or by the positions around. Private to proto. Thread-safe: no shared state.

#include <cstdint>
#include <span>
#include <vector>

#include "proto/entry_order.h"

namespace terrane {

/// How an entry's normal is predicted, as Draco numbers it.
enum class NormalPrediction : std::uint8_t {
  Difference = 0,  ///< by the one before
  Geometric = 6,   ///< by the sum of its triangles' normals, by area, or by its opposite
};

/// More triangles around a vertex are refused by what learns an order: up to here all sums are exact in double.
inline constexpr std::uint32_t kMostFacesAroundEntry = 4096;

/// Of each entry, and of some more that do not count, so that all are worked on four at once.
struct NormalScratch {
  std::vector<float> x, y, z;
  std::vector<std::int32_t> negativeZ;               ///< 0 or -1
  std::vector<std::int32_t> wholeX, wholeY, wholeZ;  ///< a vector scaled to the grid
  std::vector<std::int32_t> s, t;                    ///< its point, behind that of an entry before the first
  std::vector<double> sums;                          ///< four for each
  std::vector<std::uint8_t> flips;                   ///< whether a prediction's opposite is used; of entries only
};

/// Fills x, y, z and negativeZ. False: a normal that is not finite, or whose squared length is not within 1e-12 and
/// 1e12.
bool gatherNormals(std::span<const float> normals, const EntryOrder& order, NormalScratch& scratch);

/// symbols: two for each entry. Precondition: gatherNormals passed; bits: 2 to 16.
void differenceSymbols(int bits, const EntryOrder& order, NormalScratch& scratch, std::vector<std::uint32_t>& symbols);

/// The same predicted by positions: four numbers of 16 bits for each entry, the fourth not used. Fills flips.
void geometricSymbols(int bits, std::span<const std::int32_t> positions, const EntryOrder& order,
                      NormalScratch& scratch, std::vector<std::uint32_t>& symbols);

}  // namespace terrane

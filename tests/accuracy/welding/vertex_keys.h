#pragma once
// One integer for a vertex of the icosahedral sphere, whichever face or tile it is seen from. A point lies in one of
// the icosahedron's 62 cells: at a vertex, within an edge, or within a face; and there it has no, one or two weights
// that do not depend on the face. Exact; thread-safe.

#include <compare>
#include <cstdint>

#include "common/tiling/triangle_tile.h"

namespace terrane::accuracy {

/// 0..11 the vertices, 12..41 the edges, 42..61 the faces.
inline constexpr unsigned kIcosahedronCells = 62;

struct CellPoint {
  unsigned cell = 0;
  /// Of an edge: at the end whose vertex has the higher number. Of a face: at its corners 0 and 1. Otherwise 0.
  std::uint64_t first = 0, second = 0;
};
/// Weights as in triangle_tile.h. Precondition: they add up to 2^gridLevel, gridLevel <= 52.
CellPoint cellPoint(int face, const FaceWeights& weights) noexcept;

/// Grid levels up to 29.
inline constexpr int kKey64MaxGridLevel = 29;
inline std::uint64_t key64(const CellPoint& p) noexcept {
  return (std::uint64_t{p.cell} << (2 * kKey64MaxGridLevel)) | (p.first << kKey64MaxGridLevel) | p.second;
}

/// All grid levels.
struct Key128 {
  std::uint64_t high = 0, low = 0;
  auto operator<=>(const Key128&) const = default;  // NOLINT(modernize-use-nullptr): clang 14
};
inline Key128 key128(const CellPoint& p) noexcept { return {(std::uint64_t{p.cell} << 58) | p.first, p.second}; }

}  // namespace terrane::accuracy

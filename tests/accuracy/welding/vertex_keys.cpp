#include "tests/accuracy/welding/vertex_keys.h"

#include <array>

namespace terrane::accuracy {
namespace {

using EdgeCells = std::array<std::array<unsigned, kTriangleCorners>, kIcosahedronFaces>;

EdgeCells makeEdgeCells() {
  EdgeCells cells{};
  unsigned next = kIcosahedronVertices;
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int edge = 0; edge < kTriangleCorners; ++edge) {
      const FaceEdge beyond = beyondFaceEdge(face, edge);
      unsigned& cell = cells[static_cast<std::size_t>(face)][static_cast<std::size_t>(edge)];
      cell = beyond.face < face ? cells[static_cast<std::size_t>(beyond.face)][static_cast<std::size_t>(beyond.edge)]
                                : next++;
    }
  }
  return cells;
}

const EdgeCells kEdgeCells = makeEdgeCells();
constexpr unsigned kFirstFaceCell = 42;

}  // namespace

CellPoint cellPoint(int face, const FaceWeights& weights) noexcept {
  const auto& corners = icosahedronCorners(face);
  int zeros = 0, zero = 0, other = 0;
  for (int k = 0; k < kTriangleCorners; ++k) {
    if (weights[k] == 0) {
      ++zeros;
      zero = k;
    } else {
      other = k;
    }
  }
  if (zeros == 2) return {static_cast<unsigned>(corners[static_cast<std::size_t>(other)]), 0, 0};
  if (zeros == 0)
    return {kFirstFaceCell + static_cast<unsigned>(face), static_cast<std::uint64_t>(weights.x),
            static_cast<std::uint64_t>(weights.y)};
  const int from = (zero + 1) % kTriangleCorners, to = (zero + 2) % kTriangleCorners;
  const int higher = corners[static_cast<std::size_t>(from)] > corners[static_cast<std::size_t>(to)] ? from : to;
  return {kEdgeCells[static_cast<std::size_t>(face)][static_cast<std::size_t>(zero)],
          static_cast<std::uint64_t>(weights[higher]), 0};
}

}  // namespace terrane::accuracy

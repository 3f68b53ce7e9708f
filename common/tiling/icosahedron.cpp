#include "common/tiling/icosahedron.h"

#include <cmath>

#include "common/numerics/strict_math.h"

namespace terrane {
namespace {

using Corners = std::array<int, kTriangleCorners>;

constexpr std::array<Corners, kIcosahedronFaces> kCorners{{
    {0, 4, 8},   {0, 9, 6},  {1, 10, 4}, {1, 6, 11}, {2, 8, 5},    //
    {2, 7, 9},   {3, 5, 10}, {3, 11, 7}, {8, 4, 5},  {10, 5, 4},   //
    {9, 7, 6},   {11, 6, 7}, {0, 8, 9},  {2, 9, 8},  {1, 11, 10},  //
    {3, 10, 11}, {4, 0, 1},  {6, 1, 0},  {5, 3, 2},  {7, 2, 3},    //
}};

constexpr int corner(const Corners& corners, int k) { return corners[static_cast<std::size_t>(k % kTriangleCorners)]; }

/// The edge beyond: the one that runs the other way.
constexpr FaceEdge beyondEdge(int face, int edge) {
  const Corners& own = kCorners[static_cast<std::size_t>(face)];
  for (int other = 0; other < kIcosahedronFaces; ++other) {
    const Corners& theirs = kCorners[static_cast<std::size_t>(other)];
    for (int k = 0; k < kTriangleCorners; ++k) {
      if (corner(theirs, k + 1) == corner(own, edge + 2) && corner(theirs, k + 2) == corner(own, edge + 1))
        return {other, k};
    }
  }
  return {-1, -1};
}

using EdgeTable = std::array<std::array<FaceEdge, kTriangleCorners>, kIcosahedronFaces>;
constexpr EdgeTable kBeyond = [] {
  EdgeTable table{};
  for (int face = 0; face < kIcosahedronFaces; ++face) {
    for (int edge = 0; edge < kTriangleCorners; ++edge)
      table[static_cast<std::size_t>(face)][static_cast<std::size_t>(edge)] = beyondEdge(face, edge);
  }
  return table;
}();

constexpr bool everyEdgeHasAFaceBeyond() {
  for (const auto& edges : kBeyond) {
    for (const FaceEdge& beyond : edges) {
      if (beyond.face < 0) return false;
    }
  }
  return true;
}
static_assert(everyEdgeHasAFaceBeyond());

constexpr double kGoldenRatio = 1.618033988749895;

}  // namespace

glm::dvec3 icosahedronVertex(int vertex) noexcept {
  const int zeroAxis = vertex / 4;
  glm::dvec3 position(0.0);
  position[(zeroAxis + 1) % 3] = (vertex & 1) != 0 ? -kIcosahedronA : kIcosahedronA;
  position[(zeroAxis + 2) % 3] = (vertex & 2) != 0 ? -kIcosahedronB : kIcosahedronB;
  return position;
}

const std::array<int, kTriangleCorners>& icosahedronCorners(int face) noexcept {
  return kCorners[static_cast<std::size_t>(face)];
}

FaceEdge beyondFaceEdge(int face, int edge) noexcept {
  return kBeyond[static_cast<std::size_t>(face)][static_cast<std::size_t>(edge)];
}

int icosahedronFaceAt(const glm::dvec3& direction) noexcept {
  // The face's centre, a vertex of the dodecahedron, is the nearest of the twenty: (1, 1, 1) or the cyclic permutations
  // of (phi, 1 / phi, 0), with any signs. Scaled, so that no sum overflows or vanishes.
  const glm::dvec3 size(std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z));
  const double largest = std::fmax(size.x, std::fmax(size.y, size.z));
  const glm::dvec3 share(size.x / largest, size.y / largest, size.z / largest);
  const auto negative = [&](int axis) { return direction[axis] < 0 ? 1 : 0; };
  int face = 4 * negative(2) + 2 * negative(1) + negative(0);
  double nearest = (share.x + share.y) + share.z;
  for (int axis = 0; axis < 3; ++axis) {
    const int second = (axis + 1) % 3;
    const double along = kGoldenRatio * share[axis] + (kGoldenRatio - 1.0) * share[second];
    if (along > nearest) {
      nearest = along;
      face = 8 + 4 * axis + 2 * negative(axis) + negative(second);
    }
  }
  return face;
}

}  // namespace terrane

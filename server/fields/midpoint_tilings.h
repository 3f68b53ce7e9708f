#pragma once
// The two schemes as midpoint displacement sees them: which places a tile's grid and the ring around it have, which
// vertices each new one lies between, and how it is named. A place is (i, j): on a tile with c cells i and j run along
// u and v, or towards corners 1 and 2, from 0 to c; -1 and c + 1 are one step beyond, in the tiles around, unfolded
// into the tile's plane.
//
// Why all tiles agree. The vertices that a new one lies between are the same from everywhere: the two ends of an edge
// of the coarser grid, or the corners of a square, which are paired by its diagonals; a sum of two does not depend on
// their order, nor does a sum of those sums. Over an edge of the solid the places beyond continue those within, and an
// edge of the grid stays one. Where the solid has a corner, a sector is missing: the two places on its sides are the
// same vertex, halfway between the corner and the same coarser vertex, so both get its height. That holds for cube and
// icosahedron alike. The place diagonally beyond a cube tile's corner would lie in the missing sector: no ring has it,
// and no vertex of a ring lies between any that a ring lacks.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/triangle_tile.h"
#include "server/fields/midpoint_keys.h"

namespace terrane::midpoint {

/// What is known of a vertex. direction: where wanted.
struct Vertex {
  glm::dvec3 direction{0.0};
  double heightMeters = 0;
};

/// A child's place (i, j) is (i, j) times sign, from here on, in half cells of a parent of one cell.
struct ChildPlace {
  int i = 0, j = 0, sign = 1;
};

inline glm::dvec3 cross(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  return glm::dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
inline double dot(const glm::dvec3& a, const glm::dvec3& b) noexcept { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
inline glm::dvec3 normalised(const glm::dvec3& p) noexcept {
  const double length = std::sqrt((p.x * p.x + p.y * p.y) + p.z * p.z);  // the order of ico_sphere.cpp
  return glm::dvec3(p.x / length, p.y / length, p.z / length);
}

/// kDirections: directions are wanted, and worked out on the way.
template <bool kDirections>
class IcoTiling {
 public:
  explicit IcoTiling(int face) noexcept : tile_{.face = face, .level = 0, .sign = 1, .base = FaceWeights(0)} {}

  void enterChild(int digit) noexcept {
    const bool centre = digit == 3;
    FaceWeights towards(centre ? 1 : 0);
    if (!centre) towards[digit] = 1;
    tile_.base = tile_.base * std::int64_t{2} + towards * std::int64_t{tile_.sign};
    if (centre) tile_.sign = -tile_.sign;
    ++tile_.level;
  }
  static ChildPlace childPlace(int digit) noexcept {
    if (digit == 3) return {1, 1, -1};
    return {digit == 1 ? 1 : 0, digit == 2 ? 1 : 0, 1};
  }

  /// Of the places with this j, margin (0 or 1) steps around the grid.
  static int firstI(int, int j, int margin) noexcept { return j < 0 ? 0 : -margin; }
  static int lastI(int cells, int j, int margin) noexcept { return j < 0 ? cells + 1 : cells - j + margin; }

  VertexKey key(int cells, int, int i, int j) const noexcept {
    return icoVertexKey(tile_.face, gridVertexWeights(tile_, cells, {i, j}));
  }

  /// A corner of the whole face, before it is moved.
  Vertex corner(int i, int j) const noexcept {
    if constexpr (!kDirections) return {};
    return {icosahedronVertex(icoCornerAt(tile_.face, gridVertexWeights(tile_, 1, {i, j}))), 0};
  }

  static GridVertex edgePlace(int cells, int edge, int k) noexcept { return edgeVertex(cells, edge, k); }

  /// What lies in the middle at place (i, j) in half cells, one of them odd, before it is moved.
  template <class Grid>
  static Vertex between(const Grid& coarse, int i, int j) noexcept {
    const int stepI = i & 1, stepJ = (j & 1) != 0 && stepI != 0 ? -1 : j & 1;
    const Vertex& a = coarse.at((i - stepI) / 2, (j - stepJ) / 2);
    const Vertex& b = coarse.at((i + stepI) / 2, (j + stepJ) / 2);
    Vertex middle;
    if constexpr (kDirections) middle.direction = normalised(a.direction + b.direction);
    middle.heightMeters = 0.5 * (a.heightMeters + b.heightMeters);
    return middle;
  }

  /// The places beside a vertex, counter-clockwise seen from outside.
  static constexpr int kNeighbours = 6;
  static constexpr std::array<GridVertex, kNeighbours> kBeside{{{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}};

 private:
  TriangleTile tile_;
};

/// Directions follow from the keys.
class CubeTiling {
 public:
  explicit CubeTiling(int face) noexcept : face_(face) {}

  void enterChild(int digit) noexcept {
    column_ = 2 * column_ + (digit & 1);
    row_ = 2 * row_ + (digit >> 1);
  }
  static ChildPlace childPlace(int digit) noexcept { return {digit & 1, digit >> 1, 1}; }

  static int firstI(int cells, int j, int margin) noexcept { return j < 0 || j > cells ? 0 : -margin; }
  static int lastI(int cells, int j, int margin) noexcept { return j < 0 || j > cells ? cells : cells + margin; }

  VertexKey key(int cells, int gridLevel, int i, int j) const noexcept {
    return cubeVertexKey(face_, gridLevel, column_ * cells + i, row_ * cells + j);
  }

  static Vertex corner(int, int) noexcept { return {}; }
  /// Bit for bit cubeGridDirection's: a component is the tangent of the point's.
  static glm::dvec3 directionOf(const VertexKey& point, int gridLevel) noexcept {
    const double scale = std::ldexp(1.0, -gridLevel);
    const auto tangent = [&](std::int64_t component) { return tanQuarterPi(static_cast<double>(component) * scale); };
    return normalised({tangent(point.a), tangent(point.b), tangent(point.c)});
  }

  /// VMin, UMax, VMax, UMin, counter-clockwise.
  static GridVertex edgePlace(int cells, int edge, int k) noexcept {
    if (edge == 0) return {k, 0};
    if (edge == 1) return {cells, k};
    return edge == 2 ? GridVertex{cells - k, cells} : GridVertex{0, cells - k};
  }

  template <class Grid>
  static Vertex between(const Grid& coarse, int i, int j) noexcept {
    const int stepI = i & 1, stepJ = j & 1;
    const auto height = [&](int towardsI, int towardsJ) {
      return coarse.at((i + towardsI) / 2, (j + towardsJ) / 2).heightMeters;
    };
    Vertex middle;
    middle.heightMeters = height(-stepI, -stepJ) + height(stepI, stepJ);
    if (stepI != 0 && stepJ != 0) middle.heightMeters = 0.5 * (middle.heightMeters + (height(1, -1) + height(-1, 1)));
    middle.heightMeters *= 0.5;
    return middle;
  }

  static constexpr int kNeighbours = 4;
  static constexpr std::array<GridVertex, kNeighbours> kBeside{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

 private:
  int face_;
  std::int64_t column_ = 0, row_ = 0;
};

}  // namespace terrane::midpoint

#include "common/tiling/triangle_tile.h"

namespace terrane {
namespace {

FaceWeights unitWeight(int corner) noexcept {
  FaceWeights weights(0);
  weights[corner] = 1;
  return weights;
}

bool isOdd(std::int64_t x) noexcept { return (x & 1) != 0; }

}  // namespace

TriangleTile triangleTile(const FacePath& path) noexcept {
  TriangleTile tile{.face = path.face(), .level = path.level()};
  for (int i = 0; i < path.level(); ++i) {
    const int digit = path.digit(i);
    const std::int64_t sign = tile.sign;
    tile.base = tile.base * std::int64_t{2} + (digit == kCentreChild ? FaceWeights(1) : unitWeight(digit)) * sign;
    if (digit == kCentreChild) tile.sign = -tile.sign;
  }
  return tile;
}

FacePath pathOf(const TriangleTile& tile) noexcept {
  // Backwards: base is odd in all weights if the last digit was 3, else in that of the last digit alone.
  std::uint64_t digits = 0;
  FaceWeights base = tile.base;
  std::int64_t sign = tile.sign;
  for (int i = 0; i < tile.level; ++i) {
    const bool centre = isOdd(base.x) && isOdd(base.y) && isOdd(base.z);
    const int digit = centre ? kCentreChild : isOdd(base.x) ? 0 : isOdd(base.y) ? 1 : 2;
    if (centre) sign = -sign;
    base = (base - (centre ? FaceWeights(1) : unitWeight(digit)) * sign) / std::int64_t{2};
    digits |= static_cast<std::uint64_t>(digit) << (2 * i);
  }
  return FacePath::fromPackedDigits(Scheme::Ico, tile.face, tile.level, digits);
}

std::array<FaceWeights, kTriangleCorners> tileCorners(const TriangleTile& tile) noexcept {
  const std::int64_t sign = tile.sign;
  return {tile.base + unitWeight(0) * sign, tile.base + unitWeight(1) * sign, tile.base + unitWeight(2) * sign};
}

std::optional<TriangleTile> tileWithCorners(int face, int level,
                                            const std::array<FaceWeights, kTriangleCorners>& corners) noexcept {
  const std::int64_t whole = std::int64_t{1} << level;
  for (const FaceWeights& corner : corners) {
    for (int k = 0; k < kTriangleCorners; ++k) {
      if (corner[k] < 0 || corner[k] > whole) return std::nullopt;
    }
    if (corner.x + corner.y + corner.z != whole) return std::nullopt;
  }
  const int sign = corners[0].x > corners[1].x ? 1 : -1;
  const TriangleTile tile{face, level, sign, corners[0] - unitWeight(0) * std::int64_t{sign}};
  if (tileCorners(tile) != corners) return std::nullopt;
  return tile;
}

FaceWeights gridVertexWeights(const TriangleTile& tile, int cells, const GridVertex& vertex) noexcept {
  const std::int64_t i = vertex.i, j = vertex.j, n = cells;
  return tile.base * n + FaceWeights(n - i - j, i, j) * std::int64_t{tile.sign};
}

std::optional<GridVertex> gridVertexAt(const TriangleTile& tile, int cells, const FaceWeights& weights) noexcept {
  const std::int64_t n = cells;
  const FaceWeights own = (weights - tile.base * n) * std::int64_t{tile.sign};
  if (own.x < 0 || own.y < 0 || own.z < 0 || own.x + own.y + own.z != n) return std::nullopt;
  return GridVertex{static_cast<int>(own.y), static_cast<int>(own.z)};
}

}  // namespace terrane

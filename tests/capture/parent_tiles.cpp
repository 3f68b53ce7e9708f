#include "tests/capture/parent_tiles.h"

#include <algorithm>

#include "common/tiling/tile_grid.h"

namespace terrane {

namespace {

enum class Where : std::uint8_t { Inside, AtUEdge, AtVEdge, AtCorner };

FacePath squareAt(std::mt19937_64& random, int face, int level, Where where) {
  const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
  const auto inside = [&] { return static_cast<std::uint32_t>(random() & last); };
  const auto border = [&] { return random() % 2 == 0 ? 0 : last; };
  const std::uint32_t column = where == Where::AtUEdge || where == Where::AtCorner ? border() : inside(),
                      row = where == Where::AtVEdge || where == Where::AtCorner ? border() : inside();
  return FacePath::cubeTile(face, level, column, row);
}

/// An edge of the face is that of its children at both ends, a corner that of one.
FacePath triangleAt(std::mt19937_64& random, int face, int level, Where where) {
  FacePath path = FacePath::wholeFace(Scheme::Ico, face);
  const int corner = static_cast<int>(random() % 3);
  for (int i = 0; i < level; ++i) {
    const int other = static_cast<int>(random() % 2);
    path = path.child(where == Where::Inside     ? static_cast<int>(random() % 4)
                      : where == Where::AtCorner ? corner
                                                 : (corner + other) % 3);
  }
  return path;
}

}  // namespace

FacePath parentOf(Scheme scheme, std::mt19937_64& random, int round) {
  const int level = round % parentLevels(scheme), pass = round / parentLevels(scheme);
  const auto where = static_cast<Where>((level + pass) % 4);
  if (scheme == Scheme::Ico) return triangleAt(random, (level + 7 * pass) % 20, level, where);
  return squareAt(random, (level / 4 + pass / 4) % 6, level, where);
}

LatticePoint latticePoint(const Tile& tile, int i, int j) {
  const TileGrid grid{tile.metadata.path.scheme(), tile.metadata.cellsPerEdge};
  const auto at = 3 * static_cast<std::size_t>(grid.index({i, j}));
  const auto& offsets = tile.mesh.offsets;
  return tile.metadata.origin + LatticePoint(offsets[at], offsets[at + 1], offsets[at + 2]);
}

LatticePoint twiceMeshPoint(const Tile& tile, int x, int y) {
  const int cells = tile.metadata.cellsPerEdge;
  const bool square = tile.metadata.path.scheme() == Scheme::Cube;
  const int i = std::min(x / 2, cells - 1), j = std::min(y / 2, square ? cells - 1 : cells - 1 - i);
  const int u = x - 2 * i, v = y - 2 * j;
  const LatticePoint v00 = latticePoint(tile, i, j), v10 = latticePoint(tile, i + 1, j),
                     v01 = latticePoint(tile, i, j + 1);
  if (!square) return v00 * std::int64_t{2 - u - v} + v10 * std::int64_t{u} + v01 * std::int64_t{v};
  const std::int64_t most = std::max(u, v), least = std::min(u, v);
  return v00 * (2 - most) + (u >= v ? v10 : v01) * (most - least) + latticePoint(tile, i + 1, j + 1) * least;
}

}  // namespace terrane

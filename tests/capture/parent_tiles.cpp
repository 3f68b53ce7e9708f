#include "tests/capture/parent_tiles.h"

#include <algorithm>

namespace terrane {

FacePath parentOf(std::mt19937_64& random, int round) {
  enum Place : std::uint8_t { Inside, AtUEdge, AtVEdge, AtCorner };
  const int level = round % kParentLevels, pass = round / kParentLevels;
  const auto place = static_cast<Place>((level + pass) % 4);
  const int face = (level / 4 + pass / 4) % 6;
  const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
  const auto inside = [&] { return static_cast<std::uint32_t>(random() & last); };
  const auto border = [&] { return random() % 2 == 0 ? 0 : last; };
  const std::uint32_t column = place == AtUEdge || place == AtCorner ? border() : inside(),
                      row = place == AtVEdge || place == AtCorner ? border() : inside();
  return FacePath::cubeTile(face, level, column, row);
}

LatticePoint latticePoint(const Tile& tile, int i, int j) {
  const auto at = 3 * static_cast<std::size_t>(j * (tile.metadata.cellsPerEdge + 1) + i);
  const auto& offsets = tile.mesh.offsets;
  return tile.metadata.origin + LatticePoint(offsets[at], offsets[at + 1], offsets[at + 2]);
}

LatticePoint twiceMeshPoint(const Tile& tile, int x, int y) {
  const int last = tile.metadata.cellsPerEdge - 1;
  const int i = std::min(x / 2, last), j = std::min(y / 2, last), u = x - 2 * i, v = y - 2 * j;
  const LatticePoint v00 = latticePoint(tile, i, j), v11 = latticePoint(tile, i + 1, j + 1);
  const LatticePoint third = u >= v ? latticePoint(tile, i + 1, j) : latticePoint(tile, i, j + 1);
  const std::int64_t most = std::max(u, v), least = std::min(u, v);
  return v00 * (2 - most) + third * (most - least) + v11 * least;
}

}  // namespace terrane

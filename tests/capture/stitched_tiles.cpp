#include "tests/capture/stitched_tiles.h"

#include <initializer_list>
#include <optional>

#include "common/view/tile_borders.h"

namespace terrane {
namespace {

struct CornerSides {
  Side corner, uEdge, vEdge;
};
constexpr CornerSides kCorners[] = {{Side::UMinVMin, Side::UMin, Side::VMin},
                                    {Side::UMaxVMin, Side::UMax, Side::VMin},
                                    {Side::UMinVMax, Side::UMin, Side::VMax},
                                    {Side::UMaxVMax, Side::UMax, Side::VMax}};

DrawnCut cutOf(std::span<const FacePath> paths) {
  DrawnCut cut;
  for (const FacePath& path : paths) cut.insert(path, 0);
  return cut;
}

/// In 0..1, of a set of tiles in any order.
float randomShare(std::uint64_t seed, std::initializer_list<std::optional<FacePath>> tiles) {
  std::uint64_t sum = seed;
  for (const auto& tile : tiles)
    if (tile) sum += std::hash<FacePath>()(*tile);
  sum *= 0x9E3779B97F4A7C15ull;
  return static_cast<float>(sum >> 40) * 0x1p-24f;
}

}  // namespace

std::vector<DrawnTile> stitchedTiles(std::span<const FacePath> paths) {
  const DrawnCut cut = cutOf(paths);
  std::vector<DrawnTile> tiles;
  for (const FacePath& path : paths) tiles.push_back({path, morphOf(cut, path)});
  return tiles;
}

std::vector<DrawnTile> tilesOnTheirWay(std::span<const FacePath> paths, std::uint64_t seed) {
  const DrawnCut cut = cutOf(paths);
  std::vector<DrawnTile> tiles = stitchedTiles(paths);
  for (DrawnTile& tile : tiles) {
    const FacePath& path = tile.path;
    const auto isFiner = [&](Side side) {
      const auto beside = path.neighbour(side);
      return beside && drawnAt(cut, *beside) == DrawnThere::Finer;
    };
    tile.morph.own = randomShare(seed, {path});
    const auto set = [&](Side side, bool finer, float share) {
      float& value = tile.morph.sides[static_cast<std::size_t>(side)];
      if (value != 1) value = finer ? 0 : share;
    };
    for (unsigned edge = 0; edge < kEdgeCount; ++edge) {
      const Side side = static_cast<Side>(edge);
      set(side, isFiner(side), randomShare(seed, {path, path.neighbour(side)}));
    }
    for (const CornerSides& at : kCorners) {
      const bool finer = isFiner(at.corner) || isFiner(at.uEdge) || isFiner(at.vEdge);
      set(at.corner, finer,
          randomShare(seed, {path, path.neighbour(at.corner), path.neighbour(at.uEdge), path.neighbour(at.vEdge)}));
    }
  }
  return tiles;
}

}  // namespace terrane

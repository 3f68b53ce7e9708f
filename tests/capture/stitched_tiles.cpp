#include "tests/capture/stitched_tiles.h"

#include <initializer_list>
#include <optional>
#include <unordered_set>

namespace terrane {
namespace {

struct CornerSides {
  Side corner, uEdge, vEdge;
};
constexpr CornerSides kCorners[] = {{Side::UMinVMin, Side::UMin, Side::VMin},
                                    {Side::UMaxVMin, Side::UMax, Side::VMin},
                                    {Side::UMinVMax, Side::UMin, Side::VMax},
                                    {Side::UMaxVMax, Side::UMax, Side::VMax}};

/// What a drawn tile can meet beyond its sides.
class Surroundings {
 public:
  explicit Surroundings(std::span<const FacePath> paths) : drawn_(paths.begin(), paths.end()) {
    for (const FacePath& path : paths)
      for (int level = 0; level < path.level(); ++level) refined_.insert(path.ancestor(level));
  }
  bool isCoarser(const FacePath& path, Side side) const {
    const auto beyond = path.neighbour(side);
    for (int level = 0; beyond && level < beyond->level(); ++level)
      if (drawn_.contains(beyond->ancestor(level))) return true;
    return false;
  }
  bool isFiner(const FacePath& path, Side side) const {
    const auto beyond = path.neighbour(side);
    return beyond && refined_.contains(*beyond);
  }

 private:
  std::unordered_set<FacePath> drawn_, refined_;
};

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
  const Surroundings around(paths);
  std::vector<DrawnTile> tiles;
  for (const FacePath& path : paths) {
    TileMorph morph;
    for (unsigned edge = 0; edge < kEdgeCount; ++edge) {
      if (!around.isCoarser(path, static_cast<Side>(edge))) continue;
      morph.sides[edge] = 1;
      morph.coarserEdges = static_cast<std::uint8_t>(morph.coarserEdges | (1u << edge));
    }
    for (const CornerSides& at : kCorners)
      if (around.isCoarser(path, at.corner) || around.isCoarser(path, at.uEdge) || around.isCoarser(path, at.vEdge))
        morph.sides[static_cast<std::size_t>(at.corner)] = 1;
    tiles.push_back({path, morph});
  }
  return tiles;
}

std::vector<DrawnTile> tilesOnTheirWay(std::span<const FacePath> paths, std::uint64_t seed) {
  const Surroundings around(paths);
  std::vector<DrawnTile> tiles = stitchedTiles(paths);
  for (DrawnTile& tile : tiles) {
    const FacePath& path = tile.path;
    tile.morph.own = randomShare(seed, {path});
    const auto set = [&](Side side, bool finer, float share) {
      float& value = tile.morph.sides[static_cast<std::size_t>(side)];
      if (value != 1) value = finer ? 0 : share;
    };
    for (unsigned edge = 0; edge < kEdgeCount; ++edge) {
      const Side side = static_cast<Side>(edge);
      set(side, around.isFiner(path, side), randomShare(seed, {path, path.neighbour(side)}));
    }
    for (const CornerSides& at : kCorners) {
      const bool finer =
          around.isFiner(path, at.corner) || around.isFiner(path, at.uEdge) || around.isFiner(path, at.vEdge);
      set(at.corner, finer,
          randomShare(seed, {path, path.neighbour(at.corner), path.neighbour(at.uEdge), path.neighbour(at.vEdge)}));
    }
  }
  return tiles;
}

}  // namespace terrane

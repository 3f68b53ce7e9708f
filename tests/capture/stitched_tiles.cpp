#include "tests/capture/stitched_tiles.h"

#include <array>

#include "common/view/tile_borders.h"

namespace terrane {
namespace {

DrawnCut cutOf(std::span<const FacePath> paths) {
  DrawnCut cut;
  for (const FacePath& path : paths) cut.insert(path, 0);
  return cut;
}

/// In 0..1, of a set of tiles in any order.
class RandomShare {
 public:
  explicit RandomShare(std::uint64_t seed) : sum_(seed) {}
  void add(const FacePath& tile) { sum_ += std::hash<FacePath>()(tile); }
  float value() const { return static_cast<float>((sum_ * 0x9E3779B97F4A7C15ull) >> 40) * 0x1p-24f; }

 private:
  std::uint64_t sum_;
};

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
    const auto set = [&](int side, std::span<const FacePath> beyond) {
      RandomShare share(seed);
      share.add(path);
      bool finer = false;
      for (const FacePath& other : beyond) {
        share.add(other);
        finer = finer || drawnAt(cut, other) == DrawnThere::Finer;
      }
      float& value = tile.morph.sides[static_cast<std::size_t>(side)];
      if (value != 1) value = finer ? 0 : share.value();
    };
    RandomShare own(seed);
    own.add(path);
    tile.morph.own = own.value();
    for (int k = 0; k < edgeCount(path.scheme()); ++k) {
      set(k, std::array{tileBeyondEdge(path, k)});
      set(kMostEdges + k, tilesAtCorner(path, k).tiles());
    }
  }
  return tiles;
}

}  // namespace terrane

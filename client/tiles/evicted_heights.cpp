#include "client/tiles/evicted_heights.h"

namespace terrane {

void EvictedHeights::remember(const FacePath& path, const ResidentTile& tile) {
  Entry& entry = tiles_[path];
  entry.tile = tile;
  entry.tile.drawable = false;
  entry.eviction = ++evictions_;
  order_.push_back({path, entry.eviction});
  // Bounding the order bounds the tiles: each of them has its latest eviction in it.
  while (order_.size() > mostTiles_) {
    const Eviction oldest = order_.front();
    order_.pop_front();
    const auto found = tiles_.find(oldest.path);
    if (found != tiles_.end() && found->second.eviction == oldest.number) tiles_.erase(found);
  }
}

void EvictedHeights::clear() {
  tiles_.clear();
  order_.clear();
}

const ResidentTile* EvictedHeights::find(const FacePath& path) const {
  const auto found = tiles_.find(path);
  return found == tiles_.end() ? nullptr : &found->second.tile;
}

}  // namespace terrane

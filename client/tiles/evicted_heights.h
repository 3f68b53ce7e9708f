#pragma once
// What is still known of tiles whose meshes were dropped: their heights, so that selection can tell that such a tile is
// out of view without asking for it again. Bounded by the number of evictions that are remembered, the oldest being
// forgotten first; an entry takes about 200 bytes. One thread.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>

#include "common/tiling/face_path.h"
#include "common/view/tile_selection.h"

namespace terrane {

class EvictedHeights {
 public:
  explicit EvictedHeights(std::size_t mostTiles) : mostTiles_(mostTiles) {}

  void remember(const FacePath& path, const ResidentTile& tile);
  void forget(const FacePath& path) { tiles_.erase(path); }
  void clear();

  /// Null if nothing is remembered; else never drawable. Valid until the next call that is not const.
  const ResidentTile* find(const FacePath& path) const;
  std::size_t size() const noexcept { return tiles_.size(); }

 private:
  struct Entry {
    ResidentTile tile;
    std::uint64_t eviction = 0;
  };
  struct Eviction {
    FacePath path;
    std::uint64_t number = 0;
  };
  std::size_t mostTiles_;
  std::uint64_t evictions_ = 0;
  std::unordered_map<FacePath, Entry> tiles_;
  std::deque<Eviction>
      order_;  ///< oldest first; of no account where the path has been forgotten or evicted again since
};

}  // namespace terrane

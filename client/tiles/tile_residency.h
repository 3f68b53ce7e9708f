#pragma once
// The tiles that are on the GPU: what they cost, when each was wanted last, which may go when the budget is exceeded,
// what is remembered of those that went, and where the ground is. No threads, no requests, no GL: bookkeeping for the
// GL thread.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/tiles/evicted_heights.h"
#include "client/tiles/ground_mesh.h"
#include "common/tiling/face_path.h"
#include "common/view/drawn_tile.h"
#include "common/view/tile_selection.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// When a tile was last wanted: by which call of want(), and at what time.
struct LastWanted {
  std::uint64_t call = 0;
  std::chrono::steady_clock::time_point time;
};

/// Evicted tiles whose heights are remembered: some 13 MiB, several flights from orbit to the ground.
inline constexpr std::size_t kRememberedTiles = 65'536;

class TileResidency {
 public:
  explicit TileResidency(std::size_t rememberedTiles = kRememberedTiles) : evicted_(rememberedTiles) {}

  /// The revision in force. When it changes, what is remembered of evicted tiles is forgotten, for heights may differ;
  /// resident tiles of another revision stay, but nothing is remembered of them.
  void setRevision(const std::string& revision);
  /// Takes the place of a tile of the same path.
  void add(const std::shared_ptr<const Tile>& tile, const ResidentTile& info, const std::string& revision,
           std::size_t gpuBytes, const LastWanted& wanted);
  /// Notes that the tile is wanted. Null if it is not resident, else the revision it is of.
  const std::string* touch(const FacePath& path, const LastWanted& wanted);

  /// What is known of a tile that is resident, or (drawable = false) of one that was. Valid until the next call that is
  /// not const.
  const ResidentTile* find(const FacePath& path) const;
  /// Null if it is not resident or nobody keeps the mesh.
  std::shared_ptr<const Tile> mesh(const FacePath& path) const;

  /// Removes the least recently wanted, finest first among equals, until the budget holds or nothing may go any more:
  /// what is in draw, what protects() says, and the ancestors of what stays.
  std::vector<FacePath> evict(std::size_t budgetBytes, const std::vector<FacePath>& draw,
                              const std::function<bool(const FacePath&, const LastWanted&)>& protects);
  /// Forgets the remembered ones too.
  void clear();

  std::size_t size() const noexcept { return tiles_.size(); }
  std::size_t rememberedSize() const noexcept { return evicted_.size(); }
  std::size_t bytes() const noexcept { return bytes_; }

  struct Ground {
    double heightMeters = 0;
    int level = 0;
  };
  /// Of the finest tile of a scheme under a direction of any length, body frame. Empty if there is none, or for a
  /// direction of no length.
  std::optional<Ground> groundBelow(const glm::dvec3& directionBody, double radiusMeters, Scheme scheme) const;
  /// Of that one of the drawn tiles which is under the direction, as it is drawn. Where none is, for a camera looks
  /// ahead and not down, of what would go on there from the nearest: a tile as fine, or the finest above it that is
  /// resident, as far on its way to its parent. Empty if nothing is drawn, or nothing is there.
  std::optional<double> drawnHeightBelow(const glm::dvec3& directionBody, double radiusMeters,
                                         const std::vector<DrawnTile>& drawn) const;

 private:
  struct Resident {
    ResidentTile info;
    std::string revision;
    GroundMesh ground;
    std::weak_ptr<const Tile> mesh;
    std::size_t bytes = 0;
    LastWanted wanted;
    std::uint64_t drawnMark = 0;
  };
  void remove(const FacePath& path);

  std::unordered_map<FacePath, Resident> tiles_;
  EvictedHeights evicted_;
  std::string revision_;
  std::unordered_map<FacePath, int> descendants_;  ///< how many resident ones a path has, itself resident or not
  std::vector<int> countAtLevel_ = std::vector<int>(FacePath::kMaxLevel + 1);
  std::size_t bytes_ = 0;
  std::uint64_t drawMark_ = 0;
};

}  // namespace terrane

#pragma once
// What is wanted, on its way and there of one body: requests, orders to the pipeline that all bodies share, residency,
// and the revision in force. Part of TileStream; GL thread only.

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/tiles/tile_pipeline.h"
#include "client/tiles/tile_residency.h"
#include "client/tiles/tile_stream.h"

namespace terrane {

class BodyTiles {
 public:
  /// pipeline and info outlive it. graceTime: as StreamOptions has it.
  BodyTiles(TilePipeline& pipeline, std::chrono::milliseconds graceTime, const BodyInfo& info);

  const BodyInfo& info() const noexcept { return *info_; }
  /// A new scene is in force. True if it has the body in another revision than before, or has it again.
  bool adopt(const SceneInfo& scene);

  /// from: as TileStream::want has it.
  void want(const std::vector<WantedTile>& wanted, const std::optional<ViewOfTiles>& from);
  /// Whatever is on its way.
  void cancelOrders();
  bool hasOrder(TilePipeline::Id id) const { return orders_.contains(id); }
  /// Of an order that it has: the tile is decoded and will be uploaded.
  void takeDecoded(TilePipeline::Id id);
  void markResident(const TilePtr& tile, std::size_t gpuBytes);
  enum class Loss : std::uint8_t { RevisionGone, NotFound, Other };
  /// Of an order that it has: it will never be ready.
  Loss takeLost(const TilePipeline::Lost& lost);
  /// Until its own tiles take no more than the budget or nothing older than so many calls of want() may go; holds: nor
  /// what stays by its parent's error.
  std::vector<FacePath> evict(std::size_t budgetBytes, const std::vector<FacePath>& draw, std::uint64_t leastAge,
                              bool holds);

  const TileResidency& residency() const noexcept { return residency_; }
  bool isMissing() const noexcept { return missing_; }  ///< the scene in force has no such body
  bool isStale() const noexcept { return stale_; }      ///< the server has said that the revision is gone
  /// A new revision is in force, and nobody has said yet what is wanted of it.
  bool isWantDue() const noexcept { return wantDue_; }
  std::size_t uploading() const noexcept { return uploading_; }
  std::size_t failed() const noexcept { return failed_; }
  std::uint64_t cancelled() const noexcept { return cancelled_; }
  std::uint64_t evicted() const noexcept { return evictions_; }

 private:
  /// A tile that is wanted, or was just now, and is not resident in the revision in force. (Residency and the request
  /// are two things: a tile of an old revision is drawn while its successor is on its way.)
  struct Request {
    enum class Stage : std::uint8_t { Ordered, Uploading, Failed };
    Stage stage = Stage::Ordered;
    TilePipeline::Id order = 0;
    double priority = 0;
    LastWanted wanted;
    std::string revision;
  };
  void wantOne(const WantedTile& tile, const LastWanted& now);
  bool stillWanted(const LastWanted& wanted, std::chrono::steady_clock::time_point now) const;
  bool isHeld(const FacePath& path) const;
  void dropUnwanted(std::chrono::steady_clock::time_point now);

  TilePipeline& pipeline_;
  std::chrono::milliseconds graceTime_;
  const BodyInfo* info_;
  std::unordered_map<FacePath, Request> requests_;
  std::unordered_map<TilePipeline::Id, FacePath> orders_;
  TileResidency residency_;
  std::optional<ViewOfTiles> from_;  ///< where the last call of want() looked from
  bool missing_ = false, stale_ = false, wantDue_ = false;
  std::size_t uploading_ = 0, failed_ = 0;
  std::uint64_t call_ = 0, cancelled_ = 0, evictions_ = 0;
};

}  // namespace terrane

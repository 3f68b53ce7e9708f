#include "client/tiles/body_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "proto/resident_tile.h"
#include "proto/tile_url.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;

/// Behind everything that is wanted.
constexpr double kUnwanted = 1000.0;
/// Behind everything in the picture.
constexpr double kBeside = 100.0;

/// What is in the picture first; level by level; within a level the larger error first, whichever body it is of.
double fetchPriority(const WantedTile& wanted) {
  const double error = std::isfinite(wanted.screenErrorPixels) ? std::max(0.0, wanted.screenErrorPixels) : 1e9;
  return wanted.path.level() + 1.0 / (1.0 + error) + (wanted.beside ? kBeside : 0.0);
}

}  // namespace

BodyTiles::BodyTiles(TilePipeline& pipeline, std::chrono::milliseconds graceTime, const BodyInfo& info)
    : pipeline_(pipeline), graceTime_(graceTime), info_(&info) {
  residency_.setRevision(info.revision);
}

bool BodyTiles::adopt(const SceneInfo& scene) {
  const auto found = std::ranges::find(scene.bodies, info_->name, &BodyInfo::name);
  const bool wasMissing = std::exchange(missing_, found == scene.bodies.end());
  if (missing_) {
    cancelOrders();
    return false;
  }
  const bool renewed = wasMissing || found->revision != info_->revision;
  info_ = &*found;
  if (!renewed) return false;
  stale_ = false;
  wantDue_ = true;
  residency_.setRevision(info_->revision);
  cancelOrders();
  std::erase_if(requests_, [](const auto& item) { return item.second.stage == Request::Stage::Failed; });
  failed_ = 0;
  return true;
}

void BodyTiles::cancelOrders() {
  for (const auto& [id, path] : orders_) {
    pipeline_.cancel(id);
    requests_.erase(path);
    ++cancelled_;
  }
  orders_.clear();
}

void BodyTiles::want(const std::vector<WantedTile>& wanted, const std::optional<ViewOfTiles>& from) {
  from_ = from;
  ++call_;
  wantDue_ = false;
  const LastWanted now{call_, Clock::now()};
  for (const WantedTile& tile : wanted) wantOne(tile, now);
  dropUnwanted(now.time);
}

void BodyTiles::wantOne(const WantedTile& tile, const LastWanted& now) {
  const std::string* revision = residency_.touch(tile.path, now);
  if (revision && *revision == info_->revision) return;
  const double priority = fetchPriority(tile);
  if (const auto found = requests_.find(tile.path); found != requests_.end()) {
    Request& request = found->second;
    request.wanted = now;
    // A camera in motion changes every error a little in every frame; only what could change the order is passed on.
    if (request.stage == Request::Stage::Ordered && std::abs(priority - request.priority) > 0.02) {
      request.priority = priority;
      pipeline_.setPriority(request.order, priority);
    }
    return;
  }
  if (stale_ || missing_) return;
  const auto order = pipeline_.order(tile.path, tileTarget({info_->revision, info_->name, tile.path}), priority);
  requests_.emplace(tile.path, Request{Request::Stage::Ordered, order, priority, now, info_->revision});
  orders_.emplace(order, tile.path);
}

/// Wanted now, or so recently that it may be wanted again.
bool BodyTiles::stillWanted(const LastWanted& wanted, Clock::time_point now) const {
  return wanted.call == call_ || (call_ - wanted.call < kGraceCalls && now - wanted.time < graceTime_);
}

bool BodyTiles::isHeld(const FacePath& path) const {
  return from_ && staysSubdivided(path, *from_, info_->selection,
                                  [this](const FacePath& other) { return residency_.find(other); });
}

void BodyTiles::dropUnwanted(Clock::time_point now) {
  for (auto at = orders_.begin(); at != orders_.end();) {
    Request& request = requests_.at(at->second);
    if (stillWanted(request.wanted, now) || isHeld(at->second)) {
      if (request.wanted.call != call_ && request.priority < kUnwanted) {
        request.priority += kUnwanted;
        pipeline_.setPriority(at->first, request.priority);
      }
      ++at;
      continue;
    }
    pipeline_.cancel(at->first);
    ++cancelled_;
    requests_.erase(at->second);
    at = orders_.erase(at);
  }
}

void BodyTiles::takeDecoded(TilePipeline::Id id) {
  const auto found = orders_.find(id);
  requests_.at(found->second).stage = Request::Stage::Uploading;
  orders_.erase(found);
  ++uploading_;
}

void BodyTiles::markResident(const TilePtr& tile, std::size_t gpuBytes) {
  const auto found = requests_.find(tile->metadata.path);
  if (found == requests_.end() || found->second.stage != Request::Stage::Uploading) return;  // of a body that was left
  --uploading_;
  const ResidentTile info = residentTile(*tile, info_->selection.radiusMeters);
  residency_.add(tile, info, found->second.revision, gpuBytes, found->second.wanted);
  requests_.erase(found);
}

BodyTiles::Loss BodyTiles::takeLost(const TilePipeline::Lost& lost) {
  const auto found = orders_.find(lost.id);
  const FacePath path = found->second;
  orders_.erase(found);
  if (lost.gone) {
    requests_.erase(path);
    stale_ = true;
    return Loss::RevisionGone;
  }
  requests_.at(path).stage = Request::Stage::Failed;
  ++failed_;
  return lost.error.kind == ErrorKind::NotFound ? Loss::NotFound : Loss::Other;
}

std::vector<FacePath> BodyTiles::evict(std::size_t budgetBytes, const std::vector<FacePath>& draw,
                                       std::uint64_t leastAge, bool holds) {
  const auto now = Clock::now();
  auto gone = residency_.evict(budgetBytes, draw, [&](const FacePath& path, const LastWanted& wanted) {
    return call_ - wanted.call < leastAge || stillWanted(wanted, now) || (holds && isHeld(path));
  });
  evictions_ += gone.size();
  return gone;
}

}  // namespace terrane

#include "client/tiles/tile_stream.h"

#include <algorithm>
#include <array>
#include <utility>

#include "client/net/fetch_queue.h"
#include "client/tiles/body_tiles.h"
#include "client/tiles/disk_cache.h"
#include "client/tiles/scene_loader.h"
#include "client/tiles/tile_pipeline.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Where bodies share the budget, tiles go in this order of age, calls of want() that they were not wanted for: exactly
/// the oldest first within a body, and so across bodies to a factor of eight.
constexpr std::array<std::uint64_t, 4> kAgesToEvict{4096, 512, 64, 0};

std::string inSeconds(milliseconds time) {
  return std::to_string(std::chrono::ceil<std::chrono::seconds>(time).count()) + " s";
}

}  // namespace

struct TileStream::State {
  StreamOptions options;
  std::unique_ptr<DiskCache> cache;
  std::unique_ptr<FetchQueue> fetch;
  std::unique_ptr<TilePipeline> pipeline;
  std::unique_ptr<SceneLoader> loader;
  const Clock::time_point opened = Clock::now();

  std::vector<std::shared_ptr<const SceneInfo>> scenes;  ///< the last is in force
  bool sceneFromCache = false, cacheOffered = false;
  bool sceneDoubted = false;  ///< a tile was not found: the server's scene, which may be another, is asked for
  int sameRevisionAgain = 0, doubts = 0;
  std::vector<std::unique_ptr<BodyTiles>> bodies;
  std::uint64_t cancelledBefore = 0, evictedBefore = 0;  ///< of bodies that were left
  std::string lastFailure;

  ~State() {
    // Workers use the network and the network calls the workers: first the one stops, then the other, then both are
    // freed.
    if (pipeline) pipeline->stop();
    fetch.reset();
    loader.reset();
  }

  /// Takes in what the threads have brought. On the GL thread, at every entrance.
  void drain() {
    auto arrival = loader->take();
    if (arrival.scene) adoptScene(std::move(arrival));
    if (scenes.empty() && !cacheOffered && Clock::now() - opened > options.slowAfter) {
      cacheOffered = true;
      loader->offerCached();
    }
    for (const TilePipeline::Lost& lost : pipeline->takeLost()) {
      const auto body = bodyOf(lost.id);
      if (!body) continue;
      const bool wasStale = bodies[*body]->isStale();
      const BodyTiles::Loss loss = bodies[*body]->takeLost(lost);
      if (loss == BodyTiles::Loss::RevisionGone) {
        if (!wasStale) loader->load();
        continue;
      }
      lastFailure = lost.error.text();
      if (loss == BodyTiles::Loss::NotFound) doubtScene();
    }
  }

  std::optional<std::size_t> bodyOf(TilePipeline::Id order) const {
    for (std::size_t body = 0; body < bodies.size(); ++body)
      if (bodies[body]->hasOrder(order)) return body;
    return std::nullopt;
  }

  bool any(bool (BodyTiles::*holds)() const noexcept) const {
    return std::ranges::any_of(bodies, [holds](const auto& body) { return ((*body).*holds)(); });
  }
  template <class Number>
  Number sum(Number (BodyTiles::*of)() const noexcept) const {
    Number total = 0;
    for (const auto& body : bodies) total += ((*body).*of)();
    return total;
  }

  milliseconds backoff(int times) const {
    return std::min(options.longestBackoff, options.firstBackoff * (1 << std::min(times, 16)));
  }

  /// A tile is not found: is there another scene? Asked at once the first time, and only that is waited for; then less
  /// and less often, however many tiles are not found, for as long as any is.
  void doubtScene() {
    if (any(&BodyTiles::isStale) || doubts > 0) return;
    sceneDoubted = true;
    ++doubts;
    loader->load();
  }

  void adoptScene(SceneLoader::Arrival arrival) {
    sceneFromCache = arrival.fromCache;
    sceneDoubted = false;
    if (scenes.empty() || scenes.back() != arrival.scene) scenes.push_back(std::move(arrival.scene));
    bool renewed = false;
    for (const auto& body : bodies) renewed = body->adopt(*scenes.back()) || renewed;
    if (renewed) sameRevisionAgain = doubts = 0;
    const std::size_t failed = sum(&BodyTiles::failed);
    if (failed == 0) lastFailure.clear();
    if (any(&BodyTiles::isMissing) || any(&BodyTiles::isStale)) {
      // The body may come back; something between us and the server may still hold the old scene. Ask again, less and
      // less often.
      loader->load(backoff(sameRevisionAgain++));
    } else if (doubts > 0 && failed > 0) {
      loader->load(backoff(doubts++ - 1));
    } else {
      doubts = 0;
    }
  }

  void selectBodies(std::span<const std::size_t> indices) {
    const std::vector<BodyInfo>& known = scenes.back()->bodies;
    const bool same = std::ranges::equal(indices, bodies, [&](std::size_t index, const auto& body) {
      return known.at(index).name == body->info().name;
    });
    if (same) {
      for (const auto& body : bodies) body->adopt(*scenes.back());
      return;
    }
    const std::vector<std::unique_ptr<BodyTiles>> left = std::exchange(bodies, {});
    for (const auto& body : left) {
      body->cancelOrders();
      cancelledBefore += body->cancelled();
      evictedBefore += body->evicted();
    }
    for (const std::size_t index : indices)
      bodies.push_back(std::make_unique<BodyTiles>(*pipeline, options.graceTime, known.at(index)));
    doubts = 0;
    lastFailure.clear();
  }

  std::vector<ArrivedTile> takeDecoded(std::size_t maxBytes) {
    std::vector<ArrivedTile> tiles;
    for (TilePipeline::Ready& ready : pipeline->takeReady(maxBytes)) {
      const auto body = bodyOf(ready.id);
      if (!body) continue;
      bodies[*body]->takeDecoded(ready.id);
      tiles.push_back({std::move(ready.tile), *body});
    }
    return tiles;
  }

  std::size_t residentBytes() const {
    std::size_t bytes = 0;
    for (const auto& body : bodies) bytes += body->residency().bytes();
    return bytes;
  }

  std::vector<std::vector<FacePath>> evict(std::span<const std::vector<FacePath>> draw) {
    std::vector<std::vector<FacePath>> gone(bodies.size());
    evictTo(options.residentBudgetBytes, draw, true, gone);
    const double most = (1 + kHeldOverBudget) * static_cast<double>(options.residentBudgetBytes);
    evictTo(static_cast<std::size_t>(most), draw, false, gone);
    return gone;
  }

  /// holds: what stays by its parent's error does.
  void evictTo(std::size_t budgetBytes, std::span<const std::vector<FacePath>> draw, bool holds,
               std::vector<std::vector<FacePath>>& gone) {
    static const std::vector<FacePath> kNothing;
    for (const std::uint64_t age : kAgesToEvict) {
      if (bodies.size() == 1 && age > 0) continue;
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        const std::size_t own = bodies[k]->residency().bytes(), others = residentBytes() - own;
        const std::size_t budget = budgetBytes - std::min(budgetBytes, others);
        const auto out = bodies[k]->evict(budget, k < draw.size() ? draw[k] : kNothing, age, holds);
        gone[k].insert(gone[k].end(), out.begin(), out.end());
      }
    }
  }

  bool idle() {
    drain();
    if (scenes.empty() || sceneDoubted || any(&BodyTiles::isStale) || any(&BodyTiles::isWantDue)) return false;
    const auto counts = pipeline->counts();
    return counts.orders == 0 && counts.lost == 0 && sum(&BodyTiles::uploading) == 0;
  }

  LinkState linkState(const FetchQueue::Status& net) const {
    if (!net.reachable) return LinkState::Offline;
    if (net.longestRunning > options.slowAfter) return LinkState::Slow;
    return net.answered ? LinkState::Online : LinkState::Connecting;
  }

  std::string message(LinkState link, const FetchQueue::Status& net, const TilePipeline::Counts& counts) const {
    std::string text;
    if (link == LinkState::Offline) {
      text = fetch->origin() + " does not answer: " +
             (net.retryIn.count() > 0 ? "retry in " + inSeconds(net.retryIn) : std::string("trying again"));
      if (sceneFromCache) text += "; showing what the disk cache holds";
      return text;
    }
    if (link == LinkState::Slow) return fetch->origin() + " is slow: waiting for " + inSeconds(net.longestRunning);
    if (net.retryIn.count() > 0) return fetch->origin() + " is busy: retry in " + inSeconds(net.retryIn);
    const bool stale = any(&BodyTiles::isStale);
    if (scenes.empty() || stale) {
      if (std::string trouble = loader->trouble(); !trouble.empty()) return trouble;
    }
    if (stale) return "the server has a new version of this body: moving over";
    for (const auto& body : bodies)
      if (body->isMissing()) return "the server no longer has the body " + body->info().name;
    if (!counts.trouble.empty() && counts.orders > 0) return counts.trouble;
    if (const std::size_t failed = sum(&BodyTiles::failed); failed > 0)
      return std::to_string(failed) + (failed == 1 ? " tile" : " tiles") + " cannot be had; last " + lastFailure;
    return cache ? cache->notice() : std::string();
  }
};

TileStream::TileStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
TileStream::~TileStream() = default;

Result<std::unique_ptr<TileStream>> TileStream::open(StreamOptions options, std::function<void()> wake) {
  auto state = std::make_unique<State>();
  state->options = std::move(options);
  const StreamOptions& chosen = state->options;
  FetchOptions network;
  network.serverUrl = chosen.serverUrl;
  network.connections = chosen.connections;
  network.timeout = chosen.requestTimeout;
  network.firstBackoff = chosen.firstBackoff;
  network.longestBackoff = chosen.longestBackoff;
  network.network = chosen.network;
  auto fetch = FetchQueue::open(network);
  if (!fetch) return fetch.error();
  state->fetch = std::move(*fetch);
  if (!chosen.cacheFile.empty()) {
    auto cache = DiskCache::open(chosen.cacheFile, chosen.cacheBudgetBytes);
    if (!cache) return cache.error();
    state->cache = std::move(*cache);
  }
  if (!wake) wake = [] {};
  PipelineOptions pipeline;
  pipeline.decodeThreads = chosen.decodeThreads;
  pipeline.firstBackoff = chosen.firstBackoff;
  pipeline.longestBackoff = chosen.longestBackoff;
  state->pipeline = std::make_unique<TilePipeline>(*state->fetch, state->cache.get(), pipeline, wake);
  state->loader = std::make_unique<SceneLoader>(*state->fetch, state->cache.get(), *state->pipeline, pipeline, wake);
  state->loader->load();
  return std::unique_ptr<TileStream>(new TileStream(std::move(state)));
}

const SceneInfo* TileStream::scene() const {
  state_->drain();
  return state_->scenes.empty() ? nullptr : state_->scenes.back().get();
}

void TileStream::selectBodies(std::span<const std::size_t> indices) { state_->selectBodies(indices); }
void TileStream::selectBody(std::size_t index) { state_->selectBodies(std::array{index}); }

const BodyInfo* TileStream::body(std::size_t which) const noexcept {
  return which < state_->bodies.size() ? &state_->bodies[which]->info() : nullptr;
}

void TileStream::want(const std::vector<WantedTile>& wanted, std::size_t body, const std::optional<ViewOfTiles>& from) {
  state_->drain();
  if (body < state_->bodies.size()) state_->bodies[body]->want(wanted, from);
}

std::vector<ArrivedTile> TileStream::takeDecoded(std::size_t maxBytes) {
  state_->drain();
  return state_->takeDecoded(maxBytes);
}

void TileStream::markResident(const ArrivedTile& arrived, std::size_t gpuBytes) {
  if (arrived.body < state_->bodies.size()) state_->bodies[arrived.body]->markResident(arrived.tile, gpuBytes);
}

std::vector<std::vector<FacePath>> TileStream::evictOfAll(std::span<const std::vector<FacePath>> draw) {
  return state_->evict(draw);
}
std::vector<FacePath> TileStream::evict(const std::vector<FacePath>& draw) {
  auto gone = state_->evict({&draw, 1});
  return gone.empty() ? std::vector<FacePath>() : std::move(gone.front());
}

const ResidentTile* TileStream::resident(const FacePath& path, std::size_t body) const {
  const ResidentTile* tile = known(path, body);
  return tile && tile->drawable ? tile : nullptr;
}

const ResidentTile* TileStream::known(const FacePath& path, std::size_t body) const {
  return body < state_->bodies.size() ? state_->bodies[body]->residency().find(path) : nullptr;
}

TilePtr TileStream::tile(const FacePath& path, std::size_t body) const {
  return body < state_->bodies.size() ? state_->bodies[body]->residency().mesh(path) : nullptr;
}

std::optional<TileStream::Ground> TileStream::groundBelow(const glm::dvec3& directionBody, std::size_t which) const {
  const BodyInfo* info = body(which);
  if (!info) return std::nullopt;
  const auto ground = state_->bodies[which]->residency().groundBelow(directionBody, info->selection.radiusMeters,
                                                                     info->selection.scheme);
  return ground ? std::optional(Ground{ground->heightMeters, ground->level}) : std::nullopt;
}

std::optional<double> TileStream::drawnHeightBelow(const glm::dvec3& directionBody, const std::vector<DrawnTile>& drawn,
                                                   std::size_t which) const {
  const BodyInfo* info = body(which);
  if (!info) return std::nullopt;
  return state_->bodies[which]->residency().drawnHeightBelow(directionBody, info->selection.radiusMeters, drawn);
}

std::size_t TileStream::residentCount(std::size_t body) const {
  return body < state_->bodies.size() ? state_->bodies[body]->residency().size() : 0;
}

bool TileStream::idle() const { return state_->idle(); }

StreamStatus TileStream::status() const {
  state_->drain();
  const auto net = state_->fetch->status();
  const auto counts = state_->pipeline->counts();
  StreamStatus status;
  status.link = state_->linkState(net);
  status.message = state_->message(status.link, net, counts);
  status.queued = counts.lookups + net.queued;
  status.fetching = net.running;
  status.decoding = counts.decoding;
  status.ready = counts.ready;
  for (const auto& body : state_->bodies) status.resident += body->residency().size();
  status.failed = state_->sum(&BodyTiles::failed);
  status.residentBytes = state_->residentBytes();
  status.requests = net.requests;
  status.bytesReceived = net.bytesReceived;
  status.cacheHits = counts.cacheHits;
  status.cancelled = state_->cancelledBefore + state_->sum(&BodyTiles::cancelled);
  status.evicted = state_->evictedBefore + state_->sum(&BodyTiles::evicted);
  status.decodeMs = counts.decodeMs;
  status.quickDecodes = counts.quickDecodes;
  status.network = state_->options.network;
  return status;
}

}  // namespace terrane

#include "client/tiles/tile_stream.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "client/net/fetch_queue.h"
#include "client/tiles/disk_cache.h"
#include "client/tiles/scene_loader.h"
#include "client/tiles/tile_pipeline.h"
#include "client/tiles/tile_residency.h"
#include "proto/resident_tile.h"
#include "proto/tile_url.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Behind everything that is wanted.
constexpr double kUnwanted = 1000.0;
/// Behind everything in the picture.
constexpr double kBeside = 100.0;

/// What is in the picture first; level by level; within a level the larger error first.
double fetchPriority(const WantedTile& wanted) {
  const double error = std::isfinite(wanted.screenErrorPixels) ? std::max(0.0, wanted.screenErrorPixels) : 1e9;
  return wanted.path.level() + 1.0 / (1.0 + error) + (wanted.beside ? kBeside : 0.0);
}

/// A tile that is wanted, or was just now, and is not resident in the revision in force. (Residency and the request are
/// two things: a tile of an old revision is drawn while its successor is on its way.)
struct Request {
  enum class Stage : std::uint8_t { Ordered, Uploading, Failed };
  Stage stage = Stage::Ordered;
  TilePipeline::Id order = 0;
  double priority = 0;
  LastWanted wanted;
  std::string revision;
};

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
  bool sceneStale = false;    ///< the server has said that our revision is gone
  bool sceneDoubted = false;  ///< a tile was not found: the server's scene, which may be another, is asked for
  bool bodyMissing = false;
  std::optional<ViewOfTiles> from;  ///< where the last call of want() looked from
  bool wantDue = false;             ///< a new revision is in force, and nobody has said yet what is wanted of it
  int sameRevisionAgain = 0, doubts = 0;
  const BodyInfo* body = nullptr;

  std::unordered_map<FacePath, Request> requests;
  std::unordered_map<TilePipeline::Id, FacePath> orders;
  TileResidency residency;
  std::size_t uploading = 0, failed = 0;
  std::uint64_t call = 0, cancelled = 0, evicted = 0;
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
      const auto found = orders.find(lost.id);
      if (found == orders.end()) continue;
      if (lost.gone) {
        requests.erase(found->second);
        if (!std::exchange(sceneStale, true)) loader->load();
      } else {
        requests.at(found->second).stage = Request::Stage::Failed;
        ++failed;
        lastFailure = lost.error.text();
        if (lost.error.kind == ErrorKind::NotFound) doubtScene();
      }
      orders.erase(found);
    }
  }

  milliseconds backoff(int times) const {
    return std::min(options.longestBackoff, options.firstBackoff * (1 << std::min(times, 16)));
  }

  /// A tile is not found: is there another scene? Asked at once the first time, and only that is waited for; then less
  /// and less often, however many tiles are not found, for as long as any is.
  void doubtScene() {
    if (sceneStale || doubts > 0) return;
    sceneDoubted = true;
    ++doubts;
    loader->load();
  }

  void adoptScene(SceneLoader::Arrival arrival) {
    const std::string name = body ? body->name : "";
    const std::string oldRevision = body ? body->revision : "";
    sceneFromCache = arrival.fromCache;
    sceneDoubted = false;
    if (scenes.empty() || scenes.back() != arrival.scene) scenes.push_back(std::move(arrival.scene));
    if (!body) return;
    const auto& bodies = scenes.back()->bodies;
    const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const BodyInfo& b) { return b.name == name; });
    const bool wasMissing = std::exchange(bodyMissing, found == bodies.end());
    if (bodyMissing) {
      cancelOrders();
      return loader->load(backoff(sameRevisionAgain++));  // it may come back
    }
    body = &*found;
    if (body->revision != oldRevision || wasMissing) {
      sameRevisionAgain = doubts = 0;
      sceneStale = false;
      wantDue = true;
      residency.setRevision(body->revision);
      cancelOrders();
      forgetFailures();
    } else if (sceneStale) {
      // Something between us and the server still holds the old scene. Ask again, less and less often.
      loader->load(backoff(sameRevisionAgain++));
    } else if (doubts > 0 && failed > 0) {
      loader->load(backoff(doubts++ - 1));
    } else {
      doubts = 0;
    }
  }

  void cancelOrders() {
    for (const auto& [id, path] : orders) {
      pipeline->cancel(id);
      requests.erase(path);
      ++cancelled;
    }
    orders.clear();
  }

  void forgetFailures() {
    std::erase_if(requests, [](const auto& item) { return item.second.stage == Request::Stage::Failed; });
    failed = 0;
    lastFailure.clear();
  }

  void selectBody(const BodyInfo& chosen) {
    const bool other = !body || body->name != chosen.name;
    body = &chosen;
    residency.setRevision(body->revision);
    if (!other) return;
    cancelOrders();
    requests.clear();
    residency.clear();
    uploading = failed = 0;
    sceneStale = bodyMissing = false;
    doubts = 0;
    lastFailure.clear();
  }

  void wantOne(const WantedTile& tile, const LastWanted& now) {
    const std::string* revision = residency.touch(tile.path, now);
    if (revision && *revision == body->revision) return;
    const double priority = fetchPriority(tile);
    if (const auto found = requests.find(tile.path); found != requests.end()) {
      Request& request = found->second;
      request.wanted = now;
      // A camera in motion changes every error a little in every frame; only what could change the order is passed on.
      if (request.stage == Request::Stage::Ordered && std::abs(priority - request.priority) > 0.02) {
        request.priority = priority;
        pipeline->setPriority(request.order, priority);
      }
      return;
    }
    if (sceneStale || bodyMissing) return;
    const auto order = pipeline->order(tile.path, tileTarget({body->revision, body->name, tile.path}), priority);
    requests.emplace(tile.path, Request{Request::Stage::Ordered, order, priority, now, body->revision});
    orders.emplace(order, tile.path);
  }

  /// Wanted now, or so recently that it may be wanted again.
  bool stillWanted(const LastWanted& wanted, Clock::time_point now) const {
    return wanted.call == call || (call - wanted.call < kGraceCalls && now - wanted.time < options.graceTime);
  }

  bool isHeld(const FacePath& path) const {
    return from && staysSubdivided(path, *from, body->selection,
                                   [this](const FacePath& other) { return residency.find(other); });
  }

  void dropUnwanted(Clock::time_point now) {
    for (auto at = orders.begin(); at != orders.end();) {
      Request& request = requests.at(at->second);
      if (stillWanted(request.wanted, now) || isHeld(at->second)) {
        if (request.wanted.call != call && request.priority < kUnwanted) {
          request.priority += kUnwanted;
          pipeline->setPriority(at->first, request.priority);
        }
        ++at;
        continue;
      }
      pipeline->cancel(at->first);
      ++cancelled;
      requests.erase(at->second);
      at = orders.erase(at);
    }
  }

  std::vector<TilePtr> takeDecoded(std::size_t maxBytes) {
    std::vector<TilePtr> tiles;
    for (TilePipeline::Ready& ready : pipeline->takeReady(maxBytes)) {
      const auto found = orders.find(ready.id);
      if (found == orders.end()) continue;
      requests.at(found->second).stage = Request::Stage::Uploading;
      orders.erase(found);
      ++uploading;
      tiles.push_back(std::move(ready.tile));
    }
    return tiles;
  }

  void markResident(const TilePtr& tile, std::size_t gpuBytes) {
    const auto found = requests.find(tile->metadata.path);
    if (found == requests.end() || found->second.stage != Request::Stage::Uploading) return;  // of a body that was left
    --uploading;
    const ResidentTile info = residentTile(*tile, body->selection.radiusMeters);
    residency.add(tile, info, found->second.revision, gpuBytes, found->second.wanted);
    requests.erase(found);
  }

  std::vector<FacePath> evict(const std::vector<FacePath>& draw) {
    const auto now = Clock::now();
    const auto recent = [&](const LastWanted& wanted) { return stillWanted(wanted, now); };
    const auto budget = static_cast<double>(options.residentBudgetBytes);
    auto gone = residency.evict(options.residentBudgetBytes, draw, [&](const FacePath& path, const LastWanted& wanted) {
      return recent(wanted) || isHeld(path);
    });
    if (static_cast<double>(residency.bytes()) > (1 + kHeldOverBudget) * budget) {
      const auto more = residency.evict(static_cast<std::size_t>((1 + kHeldOverBudget) * budget), draw,
                                        [&](const FacePath&, const LastWanted& wanted) { return recent(wanted); });
      gone.insert(gone.end(), more.begin(), more.end());
    }
    evicted += gone.size();
    return gone;
  }

  bool idle() {
    drain();
    if (scenes.empty() || sceneStale || sceneDoubted || wantDue) return false;
    const auto counts = pipeline->counts();
    return counts.orders == 0 && counts.lost == 0 && uploading == 0;
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
    if (scenes.empty() || sceneStale) {
      if (std::string trouble = loader->trouble(); !trouble.empty()) return trouble;
    }
    if (sceneStale) return "the server has a new version of this body: moving over";
    if (bodyMissing) return "the server no longer has the body " + body->name;
    if (!counts.trouble.empty() && counts.orders > 0) return counts.trouble;
    if (failed > 0)
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

void TileStream::selectBody(std::size_t index) { state_->selectBody(state_->scenes.back()->bodies.at(index)); }

const BodyInfo* TileStream::body() const noexcept { return state_->body; }

void TileStream::want(const std::vector<WantedTile>& wanted, const std::optional<ViewOfTiles>& from) {
  state_->drain();
  if (!state_->body) return;
  state_->from = from;
  ++state_->call;
  state_->wantDue = false;
  const LastWanted now{state_->call, Clock::now()};
  for (const WantedTile& tile : wanted) state_->wantOne(tile, now);
  state_->dropUnwanted(now.time);
}

std::vector<TilePtr> TileStream::takeDecoded(std::size_t maxBytes) {
  state_->drain();
  return state_->takeDecoded(maxBytes);
}

void TileStream::markResident(const TilePtr& tile, std::size_t gpuBytes) { state_->markResident(tile, gpuBytes); }

std::vector<FacePath> TileStream::evict(const std::vector<FacePath>& draw) { return state_->evict(draw); }

const ResidentTile* TileStream::resident(const FacePath& path) const {
  const ResidentTile* tile = known(path);
  return tile && tile->drawable ? tile : nullptr;
}

const ResidentTile* TileStream::known(const FacePath& path) const { return state_->residency.find(path); }

TilePtr TileStream::tile(const FacePath& path) const { return state_->residency.mesh(path); }

std::optional<TileStream::Ground> TileStream::groundBelow(const glm::dvec3& directionBody) const {
  const BodyInfo* body = state_->body;
  if (!body) return std::nullopt;
  const auto ground =
      state_->residency.groundBelow(directionBody, body->selection.radiusMeters, body->selection.scheme);
  return ground ? std::optional(Ground{ground->heightMeters, ground->level}) : std::nullopt;
}

std::optional<double> TileStream::drawnHeightBelow(const glm::dvec3& directionBody,
                                                   const std::vector<DrawnTile>& drawn) const {
  const BodyInfo* body = state_->body;
  if (!body) return std::nullopt;
  return state_->residency.drawnHeightBelow(directionBody, body->selection.radiusMeters, drawn);
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
  status.resident = state_->residency.size();
  status.failed = state_->failed;
  status.residentBytes = state_->residency.bytes();
  status.requests = net.requests;
  status.bytesReceived = net.bytesReceived;
  status.cacheHits = counts.cacheHits;
  status.cancelled = state_->cancelled;
  status.evicted = state_->evicted;
  status.decodeMs = counts.decodeMs;
  status.network = state_->options.network;
  return status;
}

}  // namespace terrane

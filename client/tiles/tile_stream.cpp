#include "client/tiles/tile_stream.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <queue>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "client/net/fetch_queue.h"
#include "client/tiles/disk_cache.h"
#include "client/tiles/ground_mesh.h"
#include "client/tiles/scene_loader.h"
#include "client/tiles/tile_pipeline.h"
#include "common/tiling/cube_sphere.h"
#include "proto/tile_url.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Behind everything that is wanted.
constexpr double kUnwanted = 1000.0;

/// Level by level, within a level the larger error first: level < value <= level + 1.
double fetchPriority(const WantedTile& wanted) {
  const double error = std::isfinite(wanted.screenErrorPixels) ? std::max(0.0, wanted.screenErrorPixels) : 1e9;
  return wanted.path.level() + 1.0 / (1.0 + error);
}

/// What the GL thread knows of one tile. Residency and the request for it are two things: a tile of an old revision is drawn while its
/// successor is on its way.
struct Entry {
  enum class Request : std::uint8_t { None, Ordered, Uploading, Failed };
  Request request = Request::None;
  TilePipeline::Id order = 0;
  double priority = 0;
  std::uint64_t wantedCall = 0;
  Clock::time_point wantedTime;

  bool resident = false;
  std::string revision;  ///< of the resident mesh
  ResidentTile info;
  GroundMesh ground;
  std::weak_ptr<const Tile> mesh;
  std::size_t bytes = 0;
  std::uint64_t drawnMark = 0;
};

std::string inSeconds(milliseconds time) { return std::to_string(std::chrono::ceil<std::chrono::seconds>(time).count()) + " s"; }

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
  bool sceneStale = false;  ///< the server has said that our revision is gone
  bool bodyMissing = false;
  int sameRevisionAgain = 0;
  const BodyInfo* body = nullptr;

  std::unordered_map<FacePath, Entry> entries;
  std::unordered_map<TilePipeline::Id, FacePath> orders;
  std::unordered_map<FacePath, int> residentBelow;  ///< how many resident descendants a path has
  std::vector<int> residentAtLevel = std::vector<int>(FacePath::kMaxLevel + 1);
  std::size_t residentCount = 0, residentBytes = 0, uploading = 0, failed = 0;
  std::uint64_t call = 0, drawMark = 0, cancelled = 0, evicted = 0;
  std::string lastFailure;

  ~State() {
    // Workers use the network and the network calls the workers: first the one stops, then the other, then both are freed.
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
      Entry& entry = entries.at(found->second);
      entry.order = 0;
      entry.request = lost.gone ? Entry::Request::None : Entry::Request::Failed;
      orders.erase(found);
      if (lost.gone) {
        if (!std::exchange(sceneStale, true)) loader->load();
      } else {
        ++failed;
        lastFailure = lost.error.text();
      }
    }
  }

  void adoptScene(SceneLoader::Arrival arrival) {
    const std::string name = body ? body->name : "";
    const std::string oldRevision = body ? body->revision : "";
    sceneFromCache = arrival.fromCache;
    scenes.push_back(std::move(arrival.scene));
    if (!body) return;
    const auto& bodies = scenes.back()->bodies;
    const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const BodyInfo& b) { return b.name == name; });
    bodyMissing = found == bodies.end();
    if (bodyMissing) {
      cancelOrders();
      return;
    }
    body = &*found;
    if (body->revision != oldRevision) {
      sameRevisionAgain = 0;
      sceneStale = false;
      cancelOrders();
      forgetFailures();
    } else if (sceneStale) {
      // Something between us and the server still holds the old scene. Ask again, less and less often.
      const int doublings = std::min(sameRevisionAgain++, 16);
      loader->load(std::min(options.longestBackoff, options.firstBackoff * (1 << doublings)));
    }
  }

  void cancelOrders() {
    for (const auto& [id, path] : orders) {
      pipeline->cancel(id);
      Entry& entry = entries.at(path);
      entry.request = Entry::Request::None;
      ++cancelled;
      if (!entry.resident) entries.erase(path);
    }
    orders.clear();
  }

  void forgetFailures() {
    for (auto at = entries.begin(); at != entries.end();) {
      if (at->second.request == Entry::Request::Failed) at->second.request = Entry::Request::None;
      at = !at->second.resident && at->second.request == Entry::Request::None ? entries.erase(at) : std::next(at);
    }
    failed = 0;
    lastFailure.clear();
  }

  void selectBody(const BodyInfo& chosen) {
    const bool other = !body || body->name != chosen.name;
    body = &chosen;
    if (!other) return;
    cancelOrders();
    entries.clear();
    residentBelow.clear();
    std::fill(residentAtLevel.begin(), residentAtLevel.end(), 0);
    residentCount = residentBytes = uploading = failed = 0;
    sceneStale = bodyMissing = false;
    lastFailure.clear();
  }

  bool mayOrder() const { return body && !sceneStale && !bodyMissing; }

  void wantOne(const WantedTile& wanted, Clock::time_point now) {
    if (!mayOrder() && !entries.contains(wanted.path)) return;
    Entry& entry = entries[wanted.path];
    entry.wantedCall = call;
    entry.wantedTime = now;
    const double priority = fetchPriority(wanted);
    if (entry.request == Entry::Request::Ordered) {
      // A camera in motion changes every error a little in every frame; only what could change the order is passed on.
      if (std::abs(priority - entry.priority) > 0.02) {
        entry.priority = priority;
        pipeline->setPriority(entry.order, priority);
      }
      return;
    }
    const bool there = entry.resident && entry.revision == body->revision;
    if (there || entry.request != Entry::Request::None || !mayOrder()) return;
    entry.priority = priority;
    entry.order = pipeline->order(wanted.path, tileTarget({body->revision, body->name, wanted.path}), priority);
    entry.request = Entry::Request::Ordered;
    orders.emplace(entry.order, wanted.path);
  }

  bool inGrace(const Entry& entry, Clock::time_point now) const {
    return call - entry.wantedCall < kGraceCalls && now - entry.wantedTime < options.graceTime;
  }

  void dropUnwanted(Clock::time_point now) {
    for (auto at = orders.begin(); at != orders.end();) {
      const auto found = entries.find(at->second);
      Entry& entry = found->second;
      if (entry.wantedCall == call || inGrace(entry, now)) {
        if (entry.wantedCall != call && entry.priority < kUnwanted) {
          entry.priority += kUnwanted;
          pipeline->setPriority(at->first, entry.priority);
        }
        ++at;
        continue;
      }
      pipeline->cancel(at->first);
      ++cancelled;
      entry.request = Entry::Request::None;
      if (!entry.resident) entries.erase(found);
      at = orders.erase(at);
    }
  }

  void setResident(const TilePtr& tile, std::size_t gpuBytes) {
    const FacePath& path = tile->metadata.path;
    const auto found = entries.find(path);
    if (found == entries.end() || found->second.request != Entry::Request::Uploading) return;  // of a body that was left
    Entry& entry = found->second;
    entry.request = Entry::Request::None;
    --uploading;
    residentBytes -= entry.bytes;
    if (!std::exchange(entry.resident, true)) {
      ++residentCount;
      ++residentAtLevel[static_cast<std::size_t>(path.level())];
      for (int level = 0; level < path.level(); ++level) ++residentBelow[path.ancestor(level)];
    }
    entry.info = ResidentTile{tile->metadata.subtreeHeights};
    entry.ground = GroundMesh::fromTile(*tile);
    entry.mesh = tile;
    entry.bytes = gpuBytes + entry.ground.bytes();
    residentBytes += entry.bytes;
  }

  void setEvicted(const FacePath& path) {
    const auto found = entries.find(path);
    Entry& entry = found->second;
    residentBytes -= entry.bytes;
    --residentCount;
    --residentAtLevel[static_cast<std::size_t>(path.level())];
    ++evicted;
    for (int level = 0; level < path.level(); ++level) {
      const auto above = residentBelow.find(path.ancestor(level));
      if (--above->second == 0) residentBelow.erase(above);
    }
    if (entry.request == Entry::Request::None) {
      entries.erase(found);
      return;
    }
    entry.resident = false;
    entry.bytes = 0;
    entry.ground = GroundMesh();
    entry.mesh.reset();
  }

  bool mayEvict(const FacePath& path, const Entry& entry, Clock::time_point now) const {
    return entry.resident && entry.drawnMark != drawMark && entry.wantedCall != call && !inGrace(entry, now) &&
           !residentBelow.contains(path);
  }

  std::vector<FacePath> evict(const std::vector<FacePath>& draw) {
    std::vector<FacePath> gone;
    if (residentBytes <= options.residentBudgetBytes) return gone;
    const auto now = Clock::now();
    ++drawMark;
    for (const FacePath& path : draw) {
      if (const auto found = entries.find(path); found != entries.end()) found->second.drawnMark = drawMark;
    }
    // Oldest first, finest first among equals; when a tile has gone, its parent may follow.
    using Candidate = std::tuple<std::uint64_t, int, FacePath>;
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
    const auto consider = [&](const FacePath& path, const Entry& entry) {
      if (mayEvict(path, entry, now)) candidates.emplace(entry.wantedCall, -path.level(), path);
    };
    for (const auto& [path, entry] : entries) consider(path, entry);
    while (residentBytes > options.residentBudgetBytes && !candidates.empty()) {
      const FacePath path = std::get<FacePath>(candidates.top());
      candidates.pop();
      setEvicted(path);
      gone.push_back(path);
      if (path.level() == 0) continue;
      for (FacePath above = path.parent();; above = above.parent()) {
        const auto found = entries.find(above);
        if (found != entries.end() && found->second.resident) {
          consider(above, found->second);
          break;
        }
        if (above.level() == 0) break;
      }
    }
    return gone;
  }

  std::optional<Ground> groundBelow(const glm::dvec3& directionBody) const {
    const double length = glm::length(directionBody);
    if (!body || !(length > 0) || !std::isfinite(length) || body->selection.scheme != Scheme::Cube) return std::nullopt;
    const glm::dvec3 direction = directionBody / length;
    const FaceCoordinates on = cubeFaceCoordinates(direction);
    for (int level = FacePath::kMaxLevel; level >= 0; --level) {
      if (residentAtLevel[static_cast<std::size_t>(level)] == 0) continue;
      const double tiles = static_cast<double>(std::uint64_t{1} << level);
      const double x = std::clamp(0.5 * (on.s + 1.0), 0.0, 1.0) * tiles, y = std::clamp(0.5 * (on.t + 1.0), 0.0, 1.0) * tiles;
      const double column = std::min(std::floor(x), tiles - 1), row = std::min(std::floor(y), tiles - 1);
      const auto found = entries.find(FacePath::cubeTile(on.face, level, static_cast<std::uint32_t>(column),
                                                         static_cast<std::uint32_t>(row)));
      if (found == entries.end() || !found->second.resident) continue;
      const auto height = found->second.ground.heightMeters(direction, x - column, y - row, body->selection.radiusMeters);
      if (height) return Ground{*height, level};
    }
    return std::nullopt;
  }

  bool idle() {
    drain();
    if (scenes.empty() || sceneStale) return false;
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
      if (const std::string trouble = loader->trouble(); !trouble.empty()) return trouble;
    }
    if (sceneStale) return "the server has a new version of this body: moving over";
    if (bodyMissing) return "the server no longer has the body " + body->name;
    if (!counts.trouble.empty() && counts.orders > 0) return counts.trouble;
    if (failed > 0) return std::to_string(failed) + (failed == 1 ? " tile" : " tiles") + " cannot be had; last " + lastFailure;
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

void TileStream::want(const std::vector<WantedTile>& wanted) {
  state_->drain();
  if (!state_->body) return;
  ++state_->call;
  const auto now = Clock::now();
  for (const WantedTile& tile : wanted) state_->wantOne(tile, now);
  state_->dropUnwanted(now);
}

std::vector<TilePtr> TileStream::takeDecoded(std::size_t maxBytes) {
  state_->drain();
  std::vector<TilePtr> tiles;
  for (TilePipeline::Ready& ready : state_->pipeline->takeReady(maxBytes)) {
    const auto found = state_->orders.find(ready.id);
    if (found == state_->orders.end()) continue;
    Entry& entry = state_->entries.at(found->second);
    entry.request = Entry::Request::Uploading;
    entry.order = 0;
    entry.revision = state_->body->revision;
    state_->orders.erase(found);
    ++state_->uploading;
    tiles.push_back(std::move(ready.tile));
  }
  return tiles;
}

void TileStream::markResident(const TilePtr& tile, std::size_t gpuBytes) { state_->setResident(tile, gpuBytes); }

std::vector<FacePath> TileStream::evict(const std::vector<FacePath>& draw) { return state_->evict(draw); }

const ResidentTile* TileStream::resident(const FacePath& path) const {
  const auto found = state_->entries.find(path);
  return found != state_->entries.end() && found->second.resident ? &found->second.info : nullptr;
}

TilePtr TileStream::tile(const FacePath& path) const {
  const auto found = state_->entries.find(path);
  return found != state_->entries.end() && found->second.resident ? found->second.mesh.lock() : nullptr;
}

std::optional<TileStream::Ground> TileStream::groundBelow(const glm::dvec3& directionBody) const {
  return state_->groundBelow(directionBody);
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
  status.resident = state_->residentCount;
  status.failed = state_->failed;
  status.residentBytes = state_->residentBytes;
  status.requests = net.requests;
  status.bytesReceived = net.bytesReceived;
  status.cacheHits = counts.cacheHits;
  status.cancelled = state_->cancelled;
  status.evicted = state_->evicted;
  status.decodeMs = counts.decodeMs;
  return status;
}

}  // namespace terrane

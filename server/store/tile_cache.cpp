#include "server/store/tile_cache.h"

#include <atomic>
#include <exception>
#include <list>
#include <mutex>
#include <unordered_map>
#include <utility>

namespace terrane {
namespace {

struct KeyHash {
  std::size_t operator()(const TileKey& key) const noexcept {
    return std::hash<FacePath>()(key.path) ^ (key.bodyIndex * 0x9E3779B97F4A7C15ull);
  }
};

std::size_t chargedBytes(const CachedTile& tile) {
  return tile.glb.capacity() + tile.etag.capacity() + tile.head.capacity() + TileCache::kEntryOverheadBytes;
}

}  // namespace

struct TileCache::Waiter {
  explicit Waiter(Callback c) : callback(std::move(c)) {}
  /// Whoever takes it first decides: the callback runs, or the ticket was dropped.
  bool take() noexcept { return !taken.exchange(true); }

  std::atomic<bool> taken{false};
  Callback callback;
};

/// A build for its waiters. All members belong to State::mutex.
struct TileCache::Flight {
  TileKey key;
  std::vector<std::shared_ptr<Waiter>> waiters;
  std::optional<WorkerPool::JobId> job;
  bool started = false;
};

struct TileCache::State : std::enable_shared_from_this<State> {
  struct Entry {
    TileKey key;
    CachedTilePtr tile;
  };
  using Recency = std::list<Entry>;  // most recently used first

  State(std::size_t bytes, WorkerPool& pool, Build b) : maxBytes(bytes), workers(pool), build(std::move(b)) {}

  const std::size_t maxBytes;
  WorkerPool& workers;  // not touched once closed
  const Build build;

  mutable std::mutex mutex;
  Recency recency;
  std::unordered_map<TileKey, Recency::iterator, KeyHash> entries;
  std::unordered_map<TileKey, std::shared_ptr<Flight>, KeyHash> flights;
  TileCacheStats stats;
  bool closed = false;

  CachedTilePtr findLocked(const TileKey& key);
  Recency keepLocked(const TileKey& key, const CachedTilePtr& tile);
  void run(const std::shared_ptr<Flight>& flight);
  void finish(const std::shared_ptr<Flight>& flight, const Result<CachedTilePtr>& result);
  Result<CachedTilePtr> buildCatching(const TileKey& key) const;
};

namespace {

/// The job in the pool's queue: run by a worker, or dropped by a pool that stops, and then the waiters must hear of it.
template <class State, class Flight>
struct BuildJob {
  std::shared_ptr<State> state;
  std::shared_ptr<Flight> flight;

  BuildJob(std::shared_ptr<State> s, std::shared_ptr<Flight> f) : state(std::move(s)), flight(std::move(f)) {}
  BuildJob(const BuildJob&) = delete;
  BuildJob& operator=(const BuildJob&) = delete;
  ~BuildJob() { state->finish(flight, makeError(ErrorKind::Cancelled, "", "the server is stopping")); }
};

}  // namespace

CachedTilePtr TileCache::State::findLocked(const TileKey& key) {
  const auto found = entries.find(key);
  if (found == entries.end()) return nullptr;
  recency.splice(recency.begin(), recency, found->second);
  return found->second->tile;
}

/// Returns what was evicted, to be freed outside the lock.
TileCache::State::Recency TileCache::State::keepLocked(const TileKey& key, const CachedTilePtr& tile) {
  Recency evicted;
  const std::size_t bytes = chargedBytes(*tile);
  if (closed || bytes > maxBytes || entries.contains(key)) return evicted;
  while (stats.bytes + bytes > maxBytes) {
    const auto oldest = std::prev(recency.end());
    stats.bytes -= chargedBytes(*oldest->tile);
    ++stats.evicted;
    entries.erase(oldest->key);
    evicted.splice(evicted.begin(), recency, oldest);
  }
  recency.push_front({key, tile});
  entries.emplace(key, recency.begin());
  stats.bytes += bytes;
  return evicted;
}

Result<CachedTilePtr> TileCache::State::buildCatching(const TileKey& key) const {
  try {
    Result<CachedTilePtr> result = build(key);
    if (result && !*result) return makeError(ErrorKind::Internal, "", "the builder returned no tile");
    return result;
  } catch (const std::exception& error) {
    return makeError(ErrorKind::Internal, "", std::string("building ") + key.path.text() + " failed: " + error.what());
  } catch (...) {
    return makeError(ErrorKind::Internal, "", "building " + key.path.text() + " failed");
  }
}

void TileCache::State::run(const std::shared_ptr<Flight>& flight) {
  {
    const std::lock_guard lock(mutex);
    if (closed || flight->waiters.empty()) return;
    flight->started = true;
    ++stats.builds;
  }
  finish(flight, buildCatching(flight->key));
}

/// Once for each flight; later calls find no waiters and do nothing.
void TileCache::State::finish(const std::shared_ptr<Flight>& flight, const Result<CachedTilePtr>& result) {
  std::vector<std::shared_ptr<Waiter>> waiters;
  Recency evicted;
  {
    const std::lock_guard lock(mutex);
    if (const auto found = flights.find(flight->key); found != flights.end() && found->second == flight)
      flights.erase(found);
    if (result) evicted = keepLocked(flight->key, *result);
    waiters.swap(flight->waiters);
  }
  for (const std::shared_ptr<Waiter>& waiter : waiters)
    if (waiter->take()) waiter->callback(result);
}

TileCache::TileCache(std::size_t maxBytes, WorkerPool& workers, Build build)
    : state_(std::make_shared<State>(maxBytes, workers, std::move(build))) {}

TileCache::~TileCache() {
  std::vector<std::shared_ptr<Flight>> open;
  {
    const std::lock_guard lock(state_->mutex);
    state_->closed = true;
    for (auto& [key, flight] : state_->flights) open.push_back(flight);
  }
  for (const std::shared_ptr<Flight>& flight : open) {
    std::optional<WorkerPool::JobId> job;
    {
      const std::lock_guard lock(state_->mutex);
      if (!flight->started) job = flight->job;
    }
    state_->finish(flight, makeError(ErrorKind::Cancelled, "", "the server is stopping"));
    if (job) state_->workers.withdraw(*job);
  }
}

CachedTilePtr TileCache::find(const TileKey& key) {
  const std::lock_guard lock(state_->mutex);
  CachedTilePtr tile = state_->findLocked(key);
  if (tile) ++state_->stats.hits;
  return tile;
}

std::unique_ptr<TileCache::Ticket> TileCache::getOrBuild(const TileKey& key, Callback callback) {
  auto waiter = std::make_shared<Waiter>(std::move(callback));
  std::shared_ptr<Flight> flight;
  CachedTilePtr hit;
  bool first = false;
  {
    const std::lock_guard lock(state_->mutex);
    hit = state_->findLocked(key);
    if (hit) {
      ++state_->stats.hits;
    } else {
      ++state_->stats.misses;
      std::shared_ptr<Flight>& slot = state_->flights[key];
      first = !slot;
      if (first) {
        slot = std::make_shared<Flight>();
        slot->key = key;
      } else {
        ++state_->stats.joined;
      }
      flight = slot;
      flight->waiters.push_back(waiter);
    }
  }
  if (hit) {
    waiter->callback(std::move(hit));
    return nullptr;
  }
  // While this call runs the flight has at least this waiter, so nobody else withdraws it before its job is known.
  auto ticket = std::make_unique<Ticket>(state_, flight, waiter);
  if (!first) return ticket;

  auto job = std::make_shared<BuildJob<State, Flight>>(state_, flight);
  const auto id = state_->workers.post(-key.path.level(), [job] { job->state->run(job->flight); });
  if (id) {
    const std::lock_guard lock(state_->mutex);
    flight->job = id;
    return ticket;
  }
  {
    const std::lock_guard lock(state_->mutex);
    ++state_->stats.refused;
  }
  state_->finish(flight, makeError(ErrorKind::Overloaded, "", "too many tiles wait to be built"));
  return nullptr;
}

TileCacheStats TileCache::stats() const {
  const std::lock_guard lock(state_->mutex);
  TileCacheStats stats = state_->stats;
  stats.entries = state_->entries.size();
  stats.inFlight = state_->flights.size();
  return stats;
}

TileCache::Ticket::Ticket(std::weak_ptr<State> state, std::shared_ptr<Flight> flight, std::shared_ptr<Waiter> waiter)
    : state_(std::move(state)), flight_(std::move(flight)), waiter_(std::move(waiter)) {}

TileCache::Ticket::~Ticket() {
  if (!waiter_->take()) return;
  const std::shared_ptr<State> state = state_.lock();
  if (!state) return;
  std::optional<WorkerPool::JobId> abandoned;
  {
    const std::lock_guard lock(state->mutex);
    std::erase(flight_->waiters, waiter_);
    const auto found = state->flights.find(flight_->key);
    const bool open = found != state->flights.end() && found->second == flight_;
    if (open && flight_->waiters.empty() && !flight_->started) {
      state->flights.erase(found);
      ++state->stats.dropped;
      if (!state->closed) abandoned = flight_->job;
    }
  }
  if (abandoned) state->workers.withdraw(*abandoned);
}

}  // namespace terrane

#include "client/tiles/tile_pipeline.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <set>
#include <thread>
#include <unordered_map>
#include <utility>

#include "proto/draco_reader.h"
#include "proto/gltf_tile.h"

namespace terrane {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// A tile that does not decode is asked for this often: a broken transfer heals, a broken tile does not.
constexpr int kMaxBadAnswers = 3;

enum class Stage : std::uint8_t { Lookup, Fetching, Encoded, Decoding, Ready };

struct Order {
  FacePath path;
  std::string target;
  double priority = 0;
  Stage stage = Stage::Lookup;
  FetchQueue::Id fetchId = 0;
  int failures = 0;    ///< in a row, for the pause
  int badAnswers = 0;  ///< bodies that were no tile
  std::vector<std::uint8_t> encoded;
  bool fromCache = false;
  TilePtr tile;
  std::size_t tileBytes = 0;
};

}  // namespace

std::size_t meshBytes(const Tile& tile) noexcept {
  const TileMesh& mesh = tile.mesh;
  return sizeof(Tile) + mesh.offsets.size() * sizeof(mesh.offsets[0]) + mesh.normals.size() * sizeof(mesh.normals[0]) +
         mesh.colors.size() + mesh.gridIndices.size() * sizeof(mesh.gridIndices[0]) +
         mesh.triangles.size() * sizeof(mesh.triangles[0]);
}

struct TilePipeline::State {
  using Queue = std::set<std::pair<double, Id>>;

  State(FetchQueue& queue, DiskCache* disk, const PipelineOptions& chosen, std::function<void()> onNews)
      : fetch(queue), cache(disk), options(chosen), wake(std::move(onNews)) {}

  Queue* queueOf(Stage stage) {
    switch (stage) {
      case Stage::Lookup:
        return &lookups;
      case Stage::Encoded:
        return &decodes;
      case Stage::Ready:
        return &ready;
      case Stage::Fetching:
      case Stage::Decoding:
        return nullptr;
    }
    return nullptr;
  }

  void work() {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [this] { return stopping || !chores.empty() || !lookups.empty() || mayDecode(); });
      if (stopping) return;
      if (!chores.empty()) {
        runChore(lock);
      } else if (!lookups.empty()) {
        lookUp(lock);
      } else {
        decode(lock);
      }
    }
  }

  bool mayDecode() const { return !decodes.empty() && readyBytes < options.readyBudgetBytes; }

  void runChore(std::unique_lock<std::mutex>& lock) {
    auto chore = std::move(chores.front());
    chores.pop_front();
    lock.unlock();
    chore();
    lock.lock();
  }

  Id takeFirst(Queue& queue) {
    const Id id = queue.begin()->second;
    queue.erase(queue.begin());
    return id;
  }

  void lookUp(std::unique_lock<std::mutex>& lock) {
    const Id id = takeFirst(lookups);
    Order& order = orders.at(id);
    order.stage = Stage::Decoding;  // nobody's queue while the disk is read
    const std::string target = order.target;
    lock.unlock();
    auto content = cache->get(target);
    lock.lock();
    const auto found = orders.find(id);
    if (found == orders.end()) return;
    if (!content) return request(found->first, found->second, milliseconds(0));
    ++cacheHits;
    found->second.fromCache = true;
    enqueueEncoded(id, found->second, std::move(*content));
  }

  /// Under the lock.
  void request(Id id, Order& order, milliseconds delay) {
    order.stage = Stage::Fetching;
    order.fromCache = false;
    order.fetchId = fetch.fetch(
        order.target, order.priority, [this, id](FetchResponse response) { onResponse(id, std::move(response)); },
        delay);
  }

  void enqueueEncoded(Id id, Order& order, std::vector<std::uint8_t> encoded) {
    order.encoded = std::move(encoded);
    order.stage = Stage::Encoded;
    decodes.emplace(order.priority, id);
    changed.notify_one();
  }

  /// On the fetch queue's thread.
  void onResponse(Id id, FetchResponse response) {
    bool lostOne = false;
    {
      const std::lock_guard lock(mutex);
      const auto found = orders.find(id);
      if (found == orders.end() || stopping) return;
      if (response.status == 200) {
        enqueueEncoded(id, found->second, std::move(response.body));
      } else {
        lostOne = onFailure(id, found->second, response);
      }
    }
    if (lostOne) wake();
  }

  /// Under the lock. True if the order is lost.
  bool onFailure(Id id, Order& order, const FetchResponse& response) {
    const int status = response.status;
    if (status == 0 && response.error.kind != ErrorKind::Io && response.error.kind != ErrorKind::Timeout) {
      return onBadAnswer(id, order, response.error);
    }
    if (status == 410) return lose(id, true, makeError(ErrorKind::Gone, order.path.text(), "an old revision"));
    if (status != 0 && status < 500 && status != 408 && status != 429) {
      const auto kind = status == 404 ? ErrorKind::NotFound : ErrorKind::InvalidArgument;
      return lose(id, false, makeError(kind, order.path.text(), "the server answers " + std::to_string(status)));
    }
    if (status != 0) trouble = order.path.text() + ": the server answers " + std::to_string(status) + ", trying again";
    // While nothing answers, the fetch queue keeps the pauses for all.
    const bool queueHolds = status == 0 && !fetch.status().reachable;
    request(id, order, queueHolds ? milliseconds(0) : std::max(response.retryAfter, pause(order)));
    return false;
  }

  milliseconds pause(Order& order) {
    const int doublings = std::min(order.failures++, 16);
    return std::min(options.longestBackoff, options.firstBackoff * (1 << doublings));
  }

  /// Under the lock. The bytes are no tile.
  bool onBadAnswer(Id id, Order& order, const Error& error) {
    trouble = order.path.text() + ": " + error.text();
    if (!order.fromCache && ++order.badAnswers >= kMaxBadAnswers) return lose(id, false, error);
    request(id, order, order.fromCache ? milliseconds(0) : pause(order));
    return false;
  }

  bool lose(Id id, bool gone, Error error) {
    orders.erase(id);
    lost.push_back({id, gone, std::move(error)});
    return true;
  }

  Result<TilePtr> decodeOne(std::span<const std::uint8_t> encoded, const FacePath& expected) {
    try {
      auto tile = decodeTile(encoded, draco);
      if (tile && tile->metadata.path != expected) {
        return makeError(ErrorKind::Malformed, "extras.terrane.path", "is " + tile->metadata.path.text());
      }
      if (!tile) return tile.error();
      return std::make_shared<const Tile>(std::move(*tile));
    } catch (const std::exception& failure) {
      return makeError(ErrorKind::Internal, "tile", failure.what());
    }
  }

  void decode(std::unique_lock<std::mutex>& lock) {
    const Id id = takeFirst(decodes);
    Order& order = orders.at(id);
    order.stage = Stage::Decoding;
    const auto encoded = std::move(order.encoded);
    const FacePath path = order.path;
    const std::string target = order.target;
    const bool fromCache = order.fromCache;
    ++decoding;
    lock.unlock();
    const auto begun = Clock::now();
    auto tile = decodeOne(encoded, path);
    const double spentMs = std::chrono::duration<double, std::milli>(Clock::now() - begun).count();
    if (!tile && fromCache) cache->remove(target);
    const bool decoded = tile.has_value();
    const std::size_t bytes = decoded ? meshBytes(**tile) : 0;

    lock.lock();
    --decoding;
    decodeMs += spentMs;
    bool news = false;
    if (const auto found = orders.find(id); found != orders.end()) {
      if (decoded) {
        found->second.tile = std::move(*tile);
        found->second.tileBytes = bytes;
        found->second.stage = Stage::Ready;
        ready.emplace(found->second.priority, id);
        readyBytes += bytes;
        trouble.clear();
        news = true;
      } else {
        news = onBadAnswer(id, found->second, tile.error());
      }
    }
    lock.unlock();
    if (news) wake();
    // Only what decodes is kept, and only after the frame has it: the disk can wait.
    if (decoded && cache && !fromCache) cache->put(target, encoded);
    lock.lock();
  }

  FetchQueue& fetch;
  DiskCache* const cache;
  const PipelineOptions options;
  const std::function<void()> wake;
  DracoReader draco;

  mutable std::mutex mutex;  ///< taken before the fetch queue's own
  std::condition_variable changed;
  bool stopping = false;
  Id nextId = 1;
  std::unordered_map<Id, Order> orders;
  Queue lookups, decodes, ready;
  std::deque<std::function<void()>> chores;
  std::vector<Lost> lost;
  std::size_t readyBytes = 0, decoding = 0;
  std::uint64_t cacheHits = 0;
  double decodeMs = 0;
  std::string trouble;
  std::vector<std::thread> workers;
};

TilePipeline::TilePipeline(FetchQueue& fetch, DiskCache* cache, const PipelineOptions& options,
                           std::function<void()> wake)
    : state_(std::make_unique<State>(fetch, cache, options, std::move(wake))) {
  for (int i = 0; i < std::clamp(options.decodeThreads, 1, 64); ++i) {
    state_->workers.emplace_back([state = state_.get()] { state->work(); });
  }
}

TilePipeline::~TilePipeline() { stop(); }

void TilePipeline::stop() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
  }
  state_->changed.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
  state_->workers.clear();
}

TilePipeline::Id TilePipeline::order(const FacePath& path, std::string target, double priority) {
  const std::lock_guard lock(state_->mutex);
  const Id id = state_->nextId++;
  Order& order = state_->orders[id];
  order.path = path;
  order.target = std::move(target);
  order.priority = priority;
  if (state_->cache) {
    state_->lookups.emplace(priority, id);
    state_->changed.notify_one();
  } else {
    state_->request(id, order, milliseconds(0));
  }
  return id;
}

void TilePipeline::setPriority(Id id, double priority) {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->orders.find(id);
  if (found == state_->orders.end()) return;
  Order& order = found->second;
  if (State::Queue* queue = state_->queueOf(order.stage)) {
    queue->erase({order.priority, id});
    queue->emplace(priority, id);
  }
  if (order.stage == Stage::Fetching) state_->fetch.setPriority(order.fetchId, priority);
  order.priority = priority;
}

void TilePipeline::cancel(Id id) {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->orders.find(id);
  if (found == state_->orders.end()) return;
  Order& order = found->second;
  if (State::Queue* queue = state_->queueOf(order.stage)) queue->erase({order.priority, id});
  if (order.stage == Stage::Fetching) state_->fetch.cancel(order.fetchId);
  if (order.stage == Stage::Ready) {
    state_->readyBytes -= order.tileBytes;
    state_->changed.notify_one();
  }
  state_->orders.erase(found);
}

std::vector<TilePipeline::Ready> TilePipeline::takeReady(std::size_t maxBytes) {
  std::vector<Ready> taken;
  const std::lock_guard lock(state_->mutex);
  std::size_t bytes = 0;
  while (!state_->ready.empty() && (taken.empty() || bytes < maxBytes)) {
    const Id id = state_->takeFirst(state_->ready);
    const auto found = state_->orders.find(id);
    bytes += found->second.tileBytes;
    state_->readyBytes -= found->second.tileBytes;
    taken.push_back({id, std::move(found->second.tile)});
    state_->orders.erase(found);
  }
  if (!taken.empty()) state_->changed.notify_all();
  return taken;
}

std::vector<TilePipeline::Lost> TilePipeline::takeLost() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->lost, {});
}

void TilePipeline::post(std::function<void()> chore) {
  const std::lock_guard lock(state_->mutex);
  state_->chores.push_back(std::move(chore));
  state_->changed.notify_one();
}

TilePipeline::Counts TilePipeline::counts() const {
  const std::lock_guard lock(state_->mutex);
  Counts counts;
  counts.orders = state_->orders.size();
  counts.lookups = state_->lookups.size();
  counts.decoding = state_->decodes.size() + state_->decoding;
  counts.ready = state_->ready.size();
  counts.lost = state_->lost.size();
  counts.cacheHits = state_->cacheHits;
  counts.decodeMs = state_->decodeMs;
  counts.quickDecodes = state_->draco.counts().quick;
  counts.trouble = state_->trouble;
  return counts;
}

}  // namespace terrane

#pragma once
// The memory cache of finished tiles, bounded in bytes, and the single flight in front of the builders: one build for
// any number of waiters; a build whose last waiter has gone is dropped before it starts. Thread-safe.
//
//   absent -> queued -> building -> cached -> evicted
//               |           \-> failed: every waiter gets the error, nothing is kept
//               \-> dropped: the last waiter left before a worker took it

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/result.h"
#include "common/tiling/face_path.h"
#include "server/store/worker_pool.h"

namespace terrane {

/// What a response needs, ready to send.
struct CachedTile {
  std::vector<std::uint8_t> glb;
  std::string etag;  ///< quoted, strong: hash of the bytes
  std::string head;  ///< status line and headers of the 200 response, without Date, Connection and the blank line
};
using CachedTilePtr = std::shared_ptr<const CachedTile>;

struct TileKey {
  std::uint32_t bodyIndex = 0;
  FacePath path;
  bool operator==(const TileKey&) const = default;
};

struct TileCacheStats {
  std::uint64_t hits = 0;     ///< of find and getOrBuild
  std::uint64_t misses = 0;   ///< of getOrBuild
  std::uint64_t joined = 0;   ///< waiters that shared a build under way
  std::uint64_t builds = 0;   ///< started
  std::uint64_t dropped = 0;  ///< withdrawn before they started
  std::uint64_t refused = 0;  ///< the queue was full
  std::uint64_t evicted = 0;
  std::size_t bytes = 0, entries = 0;
  std::size_t inFlight = 0;  ///< queued and building
};

class TileCache {
 public:
  using Build = std::function<Result<CachedTilePtr>(const TileKey&)>;
  using Callback = std::function<void(Result<CachedTilePtr>)>;

  /// A wait for a build. Its destructor withdraws the wait: afterwards the callback does not begin any more (it may be
  /// running).
  class Ticket;

  /// What one tile may cost beside its bytes: list node, hash node, control block.
  static constexpr std::size_t kEntryOverheadBytes = 256;

  /// maxBytes counts kEntryOverheadBytes a tile too; a tile larger than that is served but not kept. The pool must
  /// outlive the cache, and what build refers to must outlive the pool's threads.
  TileCache(std::size_t maxBytes, WorkerPool& workers, Build build);
  /// Waiters get Cancelled. A build that runs goes on to its end, for nobody.
  ~TileCache();
  TileCache(const TileCache&) = delete;
  TileCache& operator=(const TileCache&) = delete;

  /// A finished tile at once, or null, which counts nothing: getOrBuild follows.
  CachedTilePtr find(const TileKey& key);

  /// Calls back exactly once, unless the ticket is dropped first: at once in this thread on a hit or when the queue is
  /// full (Overloaded), and then there is no ticket; otherwise from a worker, with the tile, the build's error, or
  /// Cancelled when cache or pool stop. Coarser tiles are built first. The callback must not throw. Errors are not
  /// cached.
  [[nodiscard]] std::unique_ptr<Ticket> getOrBuild(const TileKey& key, Callback callback);

  TileCacheStats stats() const;

 private:
  struct State;
  struct Flight;
  struct Waiter;
  std::shared_ptr<State> state_;
};

class TileCache::Ticket {
 public:
  Ticket(std::weak_ptr<State> state, std::shared_ptr<Flight> flight, std::shared_ptr<Waiter> waiter);
  ~Ticket();
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;

 private:
  std::weak_ptr<State> state_;
  std::shared_ptr<Flight> flight_;
  std::shared_ptr<Waiter> waiter_;
};

}  // namespace terrane

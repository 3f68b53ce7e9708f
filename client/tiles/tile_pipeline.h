#pragma once
// Orders of single tiles on their way through threads: disk cache, network, decoder. Each order goes
//   lookup -> fetching -> waiting to be decoded -> decoding -> ready (taken by takeReady)
//                \-> once more after a pause            \-> failed, gone (takeLost)
// in order of priority at every stage. Thread-safe; the callback tells that something new is there to be taken.
//
// What is ready is bounded in bytes: decoding pauses until the GL thread has taken some, so that a slow frame cannot
// fill the memory.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/net/fetch_queue.h"
#include "client/tiles/disk_cache.h"
#include "client/tiles/tile_stream.h"
#include "common/result.h"
#include "proto/tile_mesh.h"

namespace terrane {

/// Bytes of a tile's arrays in main memory.
std::size_t meshBytes(const Tile& tile) noexcept;

struct PipelineOptions {
  int decodeThreads = 1;
  std::size_t readyBudgetBytes = 16u << 20;
  std::chrono::milliseconds firstBackoff{250}, longestBackoff{15'000};
};

class TilePipeline {
 public:
  using Id = std::uint64_t;

  /// cache may be null. Both outlive the pipeline's threads; see stop().
  TilePipeline(FetchQueue& fetch, DiskCache* cache, const PipelineOptions& options, std::function<void()> wake);
  ~TilePipeline();
  /// Ends the worker threads. Afterwards nothing calls the fetch queue any more; its callbacks may still come in.
  void stop();

  /// Lower priority values go first.
  Id order(const FacePath& path, std::string target, double priority);
  void setPriority(Id id, double priority);
  /// Forgets the order wherever it is. The fetch queue decides whether closing a connection saves anything.
  void cancel(Id id);

  struct Ready {
    Id id;
    TilePtr tile;
  };
  /// At most about maxBytes of meshes, at least one if there is any.
  std::vector<Ready> takeReady(std::size_t maxBytes);

  struct Lost {
    Id id;
    bool gone = false;  ///< the server says that the revision is an old one
    Error error;
  };
  /// Orders that will never be ready.
  std::vector<Lost> takeLost();

  /// Runs on a worker thread before any tile.
  void post(std::function<void()> chore);

  struct Counts {
    std::size_t orders = 0;  ///< in any stage
    std::size_t lookups = 0, decoding = 0, ready = 0, lost = 0;
    std::uint64_t cacheHits = 0;
    double decodeMs = 0;
    std::uint64_t quickDecodes = 0;  ///< of tiles whose kind was known, as all but the first ones should be
    std::string trouble;             ///< why the last answer was no tile; empty after a tile
  };
  Counts counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace terrane

#pragma once
// Everything between "this tile is wanted" and "here is its mesh": requests over a few kept connections, the disk
// cache, decoding on worker threads, residency and memory budgets. The GL thread calls it once a frame and never waits
// in it.
//
//   absent -> queued -> fetching -> decoding -> ready (takeDecoded) -> resident (uploaded) -> evicted = absent
//                \-> failed (back-off, then queued again)
//
// Of an evicted tile the heights are remembered, so that it is not fetched again only to learn that it is out of view.
//
// Hysteresis lives here, so that a camera that hovers at a threshold costs nothing: what is no longer wanted goes on
// loading, behind all that is wanted, and is not evicted, while its parent's error is above half of what is allowed
// (common/view/level_hysteresis.h); and for kGraceCalls calls of want() or graceTime, whichever ends first, for a
// camera that turns to and fro.
//
// When the server says that the revision is gone, or does not find a tile and has another revision, scene() becomes
// another scene and every tile is asked for again as it is wanted; the old ones stay resident and drawn until their
// successors are. Without a server the disk cache's scene and tiles are used.
//
// Tiles may be wanted of several bodies at once: they share connections, disk cache, workers and the budget, and what
// is asked for first is decided over all of them (level by level, within a level the larger error first). What is said
// and asked of one body takes its place among the selected ones; 0 is the first, or only one.
//
// All members are for one thread (the GL thread), except where they say otherwise.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/net/simulated_link.h"
#include "common/result.h"
#include "common/view/drawn_tile.h"
#include "common/view/level_hysteresis.h"
#include "common/view/tile_selection.h"
#include "proto/scene_json.h"
#include "proto/tile_mesh.h"

namespace terrane {

struct StreamOptions {
  std::string serverUrl;  ///< http://host:port
  int connections = 6;
  int decodeThreads = 1;
  /// Tiles on the GPU and their CPU copies; what is drawn is never evicted.
  std::size_t residentBudgetBytes = 128u << 20;
  std::string cacheFile;  ///< SQLite file; empty: no disk cache
  std::size_t cacheBudgetBytes = 512u << 20;
  std::chrono::milliseconds requestTimeout{30'000};
  std::chrono::milliseconds graceTime{500};
  std::chrono::milliseconds slowAfter{2'000};  ///< a request that waits longer makes the link Slow
  /// Pauses between attempts double from the one to the other.
  std::chrono::milliseconds firstBackoff{250}, longestBackoff{15'000};
  NetworkConditions network = {};  ///< to fly under a worse network than the real one
};

/// Calls of want() for which a tile that is no longer wanted is treated as if it were (or StreamOptions::graceTime).
inline constexpr std::uint64_t kGraceCalls = 30;

/// As a share of the budget.
inline constexpr double kHeldOverBudget = 0.5;

enum class LinkState : std::uint8_t { Connecting, Online, Slow, Offline };

struct StreamStatus {
  LinkState link = LinkState::Connecting;
  std::string message;  ///< one line for the HUD, e.g. "server does not answer: retry in 4 s"; empty when all is well
  std::size_t queued = 0, fetching = 0, decoding = 0, ready = 0, resident = 0, failed = 0;
  std::size_t residentBytes = 0;
  std::uint64_t requests = 0, bytesReceived = 0, cacheHits = 0, cancelled = 0, evicted = 0;
  double decodeMs = 0;             ///< summed over workers
  std::uint64_t quickDecodes = 0;  ///< tiles whose kind was known: see DracoReader
  NetworkConditions network;       ///< what is simulated, as asked
};

/// A decoded tile on its way to the GPU.
using TilePtr = std::shared_ptr<const Tile>;
struct ArrivedTile {
  TilePtr tile;
  std::size_t body = 0;  ///< its place among the selected bodies
};

class TileStream {
 public:
  /// Starts the threads; does not wait for the server. wake is called from any thread when something arrived (an idle
  /// viewer sleeps). Errors: InvalidArgument naming "--server", Io naming the cache file.
  static Result<std::unique_ptr<TileStream>> open(StreamOptions options, std::function<void()> wake);
  ~TileStream();

  /// Asks for scene.json until it is there (again when the server says that the revision is gone). Null before. A new
  /// scene is a new object; the old ones live as long as the stream.
  const SceneInfo* scene() const;
  /// Chooses the bodies whose tiles are wanted, by their places in scene()->bodies. If they are others than before,
  /// nothing is resident any more (clear the renderer). Precondition: scene() is not null, indices in range and each
  /// once.
  void selectBodies(std::span<const std::size_t> indices);
  void selectBody(std::size_t index);
  /// What is in force of a chosen body: a new scene's, wherever it stands in there, or the last one that had it. Null
  /// where none is chosen.
  const BodyInfo* body(std::size_t which = 0) const noexcept;

  /// Once a frame for every body: what is wanted of it now, coarsest first. Queued and running requests for anything
  /// else of it are cancelled. from: where it is wanted from; without it there is no holding by error, only the grace.
  void want(const std::vector<WantedTile>& wanted, std::size_t body = 0,
            const std::optional<ViewOfTiles>& from = std::nullopt);
  /// Decoded tiles to upload now, at most about maxBytes of them (at least one if any is ready), coarsest first.
  std::vector<ArrivedTile> takeDecoded(std::size_t maxBytes);
  /// The tile is on the GPU and may be drawn; if it was resident before, it takes that one's place. gpuBytes count
  /// towards the budget, with the few bytes a vertex that stay in main memory for groundBelow. The rest of the mesh is
  /// the caller's to keep or drop.
  void markResident(const ArrivedTile& arrived, std::size_t gpuBytes);
  /// Drops what is over budget, least recently wanted first; never what is in draw, what was wanted just now or within
  /// the grace, nor an ancestor of what stays. So a view that needs more than the budget gets it. What stays by its
  /// parent's error alone may take kHeldOverBudget more than the budget. The caller frees the GL objects. The budget
  /// holds for all bodies together; among several, ages count to a factor of eight. By body.
  std::vector<std::vector<FacePath>> evictOfAll(std::span<const std::vector<FacePath>> draw);
  /// Of the only body.
  std::vector<FacePath> evict(const std::vector<FacePath>& draw);

  /// Null unless the tile's mesh is there to be drawn.
  const ResidentTile* resident(const FacePath& path, std::size_t body = 0) const;
  /// For selection: also what is remembered of a tile that was evicted (drawable = false). The heights of the last
  /// kRememberedTiles of them are, until the revision changes.
  const ResidentTile* known(const FacePath& path, std::size_t body = 0) const;
  /// Null if it is not resident, or if nobody else keeps the mesh.
  TilePtr tile(const FacePath& path, std::size_t body = 0) const;
  std::size_t residentCount(std::size_t body = 0) const;

  /// Height of the finest resident tile's triangle under a direction, metres above the reference sphere; empty if there
  /// is none.
  struct Ground {
    double heightMeters = 0;
    int level = 0;
  };
  std::optional<Ground> groundBelow(const glm::dvec3& directionBody, std::size_t body = 0) const;
  /// Height of what is drawn under a direction, morphed as it is drawn, metres above the reference sphere. Coarser than
  /// groundBelow's while fine tiles have come but not grown in yet. Empty where nothing is drawn.
  std::optional<double> drawnHeightBelow(const glm::dvec3& directionBody, const std::vector<DrawnTile>& drawn,
                                         std::size_t body = 0) const;

  /// Nothing is queued, fetching, decoding or ready, and nothing waits for a retry. (A viewer that lives on its disk
  /// cache is idle although it goes on trying to reach the server.)
  bool idle() const;
  StreamStatus status() const;

 private:
  struct State;
  explicit TileStream(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane

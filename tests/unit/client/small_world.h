#pragma once
// A fake server of small tiles with one switch for everything that can go wrong, and a viewer without a picture that
// steps a TileStream frame by frame as the GL thread would.

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "client/tiles/tile_stream.h"
#include "tests/unit/client/fake_server.h"
#include "tests/unit/client/small_tiles.h"

namespace terrane::testing {

FacePath path(std::string_view text);
/// The tile and all above it, coarsest first.
std::vector<WantedTile> chain(const FacePath& leaf, double errorPixels = 4);
/// Without doubles, coarsest first.
std::vector<WantedTile> together(std::initializer_list<std::vector<WantedTile>> sets);
/// What is asked for when a tile of the first body is wanted.
std::string target(const FacePath& tile, const std::string& revision = kRevision);

class SmallWorld {
 public:
  SmallWorld() = default;
  explicit SmallWorld(std::string revision) : revision_(std::move(revision)) {}

  /// Starts, or starts again on the same port.
  void start();
  void stop() { server_.reset(); }
  FakeServer& server() { return *server_; }
  int port();
  std::string url();

  using Rule = std::function<FakeReply(const std::string& target, const FakeReply& usual)>;
  /// Changes answers from now on.
  void setRule(Rule rule);
  void setRevision(const std::string& revision);
  /// How often a target that ends so was asked for, over all starts.
  int asked(const std::string& ending) const;
  int tilesAsked() const;

 private:
  FakeReply answer(const std::string& target);

  mutable std::mutex mutex_;
  std::string revision_ = kRevision;
  Rule rule_;
  std::map<std::string, int> asked_;
  int port_ = 0;
  std::unique_ptr<FakeServer> server_;
};

/// Answers a target that ends so wrongly for the first times it is asked for.
SmallWorld::Rule wrongAtFirst(const std::string& ending, int times, const FakeReply& wrong);

/// Every answer to a target that ends so waits until it is released.
SmallWorld::Rule holding(const std::string& ending);

/// One that is up from the start.
class RunningWorld : public SmallWorld {
 public:
  explicit RunningWorld(Rule rule = nullptr);
};

/// Short pauses, no grace, so that tests need not wait.
StreamOptions quickOptions(const std::string& url);

class SmallViewer {
 public:
  static constexpr std::size_t kGpuBytes = 10'000;

  explicit SmallViewer(const StreamOptions& options);

  TileStream& stream() { return *stream_; }
  /// Steps until scene() is there and selects its first body; false after a generous time.
  bool waitForScene();
  /// One frame: what is wanted, uploads, evictions. Draws what is resident of the wanted.
  void frame(const std::vector<WantedTile>& wanted);
  /// Frames until the stream is idle.
  bool settle(const std::vector<WantedTile>& wanted);
  /// Frames until the condition holds.
  bool stepUntil(const std::vector<WantedTile>& wanted, const std::function<bool()>& reached);
  /// Waits, without a frame, until the stream has called wake since the last time.
  bool waitForWake();

  std::vector<FacePath> evicted;  ///< by all frames so far
  std::set<FacePath> uploaded;    ///< resident now
  int uploads = 0;

 private:
  struct Bell {
    std::mutex mutex;
    std::condition_variable rung;
    bool ringing = false;
  };
  std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  std::unique_ptr<TileStream> stream_;
};

}  // namespace terrane::testing

// A camera that hovers where a level begins costs nothing: over 1,000 steps to and fro no tile is asked for, built or
// evicted twice, on tiles of both schemes. The controls take hysteresis, slack and grace away.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <thread>

#include "client/tiles/tile_stream.h"
#include "server/http/http_server.h"
#include "tests/support/both_schemes.h"
#include "tests/support/moon_body.h"
#include "tests/support/sanitizers.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kGpuBytes = 100'000;
constexpr int kSteps = test::kSanitized ? 100 : 1000;
constexpr double kErrorPixels = 2;
constexpr std::size_t kServerCache = 64u << 20;

/// Builds the Moon's tiles, in this process, over real sockets.
class MoonServer {
 public:
  MoonServer(Scheme scheme, std::size_t memoryCacheBytes) : service_(scene(scheme), options(memoryCacheBytes)) {
    ServerOptions listening;
    listening.listen = {"127.0.0.1:0"};
    auto opened = HttpServer::open(listening, service_);
    EXPECT_TRUE(opened) << opened.error().text();
    server_ = *std::move(opened);
    thread_ = std::thread([this] { server_->run(); });
  }
  ~MoonServer() {
    server_->stop();
    thread_.join();
  }
  std::string url() const { return server_->urls().at(0); }
  TileCacheStats cache() const { return service_.cacheStats(); }

 private:
  static Scene scene(Scheme scheme) { return {"moon", "", {tiledBy(scheme, testMoon())}, {}}; }
  static TileService::Options options(std::size_t memoryCacheBytes) {
    TileService::Options chosen;
    chosen.threads = 1;
    chosen.memoryCacheBytes = memoryCacheBytes;
    return chosen;
  }
  TileService service_;
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

Camera cameraAt(double altitudeMeters) {
  return cameraFromPose({-0.286, 0.377, altitudeMeters, 0.4, -0.6}, testMoon().radiusMeters, 0.9, 640, 360);
}

/// A viewer without a picture.
class Viewer {
 public:
  Viewer(const std::string& url, std::size_t budgetBytes, std::chrono::milliseconds grace, bool hysteresis)
      : hysteresis_(hysteresis) {
    StreamOptions options;
    options.serverUrl = url;
    options.residentBudgetBytes = budgetBytes;
    options.graceTime = grace;
    auto stream = TileStream::open(options, nullptr);
    EXPECT_TRUE(stream) << stream.error().text();
    stream_ = std::move(*stream);
    EXPECT_TRUE(eventually([this] { return stream_->scene() != nullptr; }));
    stream_->selectBody(0);
  }

  const TileSelection& frame(double altitudeMeters) {
    selection_ =
        selectTiles(cameraAt(altitudeMeters), stream_->body()->selection,
                    [this](const FacePath& path) { return stream_->known(path); }, {.errorPixels = kErrorPixels});
    stream_->want(selection_.wanted, 0,
                  hysteresis_ ? std::optional(ViewOfTiles{cameraAt(altitudeMeters), kErrorPixels}) : std::nullopt);
    for (const ArrivedTile& tile : stream_->takeDecoded(64 << 20)) stream_->markResident(tile, kGpuBytes);
    for (const FacePath& path : stream_->evict(selection_.draw)) evictedTwice += evicted_.insert(path).second ? 0 : 1;
    return selection_;
  }
  const TileSelection& settle(double altitudeMeters) {
    EXPECT_TRUE(eventually([&] {
      frame(altitudeMeters);
      return selection_.complete && stream_->idle();
    }));
    return selection_;
  }
  StreamStatus status() const { return stream_->status(); }
  int finestLevel() const { return selection_.wanted.back().path.level(); }

  int evictedTwice = 0;

 private:
  template <class Condition>
  static bool eventually(Condition condition) {
    for (int i = 0; i < 60'000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }

  bool hysteresis_;
  std::unique_ptr<TileStream> stream_;
  TileSelection selection_;
  std::set<FacePath> evicted_;
};

/// Two altitudes a thousandth apart, between which a level begins; and what both together want.
struct Threshold {
  double above = 40'000, below = 20'000;
  std::size_t tiles = 0, bytes = 0;  ///< of both sides
};

Threshold findThreshold(const std::string& url) {
  Viewer viewer(url, std::size_t{1} << 40, 1h, false);
  Threshold found;
  viewer.settle(found.above);
  const int coarse = viewer.finestLevel();
  while (found.above / found.below > 1.001) {
    const double middle = std::sqrt(found.above * found.below);
    viewer.settle(middle);
    (viewer.finestLevel() > coarse ? found.below : found.above) = middle;
  }
  std::set<FacePath> wanted;
  for (const double altitude : {found.above, found.below})
    for (const WantedTile& tile : viewer.settle(altitude).wanted) wanted.insert(tile.path);
  found.tiles = wanted.size();
  const StreamStatus status = viewer.status();
  found.bytes = status.residentBytes / status.resident * found.tiles;  // all tiles have the same grid
  return found;
}

struct Hovering {
  std::uint64_t requests = 0, evicted = 0, builds = 0, hits = 0;  ///< during the steps
  int evictedTwice = 0;
};

struct Slack {
  std::size_t budgetBytes = 0;
  std::chrono::milliseconds grace{0};
  bool hysteresis = false;
};

/// Settles on both sides first. patient: waits on each side until all is there.
Hovering hover(Scheme scheme, const Threshold& threshold, const Slack& slack, int steps, bool patient,
               std::size_t serverCacheBytes = kServerCache) {
  const MoonServer server(scheme, serverCacheBytes);
  Viewer viewer(server.url(), slack.budgetBytes, slack.grace, slack.hysteresis);
  for (const double altitude : {threshold.below, threshold.above, threshold.below}) viewer.settle(altitude);
  const StreamStatus before = viewer.status();
  const TileCacheStats cacheBefore = server.cache();
  viewer.evictedTwice = 0;
  for (int step = 0; step < steps; ++step) {
    const double altitude = step % 2 == 0 ? threshold.above : threshold.below;
    if (patient) {
      viewer.settle(altitude);
    } else {
      viewer.frame(altitude);
    }
  }
  viewer.settle(threshold.below);
  const StreamStatus after = viewer.status();
  const TileCacheStats cacheAfter = server.cache();
  return {after.requests - before.requests, after.evicted - before.evicted, cacheAfter.builds - cacheBefore.builds,
          cacheAfter.hits - cacheBefore.hits, viewer.evictedTwice};
}

void print(const char* what, int steps, const Hovering& hovering) {
  std::printf(
      "%s: %d steps, %llu requests, %llu evictions (%d of a tile that went before), %llu builds, %llu cache hits\n",
      what, steps, static_cast<unsigned long long>(hovering.requests),
      static_cast<unsigned long long>(hovering.evicted), hovering.evictedTwice,
      static_cast<unsigned long long>(hovering.builds), static_cast<unsigned long long>(hovering.hits));
}

class LevelThreshold : public testing::TestWithParam<Scheme> {};

TEST_P(LevelThreshold, AThousandStepsToAndFroRequestBuildAndEvictNothingTwice) {
  const Threshold threshold = [] {
    const MoonServer server(GetParam(), kServerCache);
    return findThreshold(server.url());
  }();
  std::printf("a level begins between %.1f and %.1f m; both sides want %zu tiles, %zu bytes\n", threshold.below,
              threshold.above, threshold.tiles, threshold.bytes);
  const auto hovering = [&](const Slack& slack, int steps, bool patient) {
    return hover(GetParam(), threshold, slack, steps, patient);
  };

  // Too little for both sides, and no grace: what is between half of the allowed error and all of it stays.
  const std::size_t tooLittle = threshold.bytes - threshold.bytes / threshold.tiles;
  const Hovering held = hovering({.budgetBytes = tooLittle, .hysteresis = true}, kSteps, true);
  print("a tile too little, hysteresis", kSteps, held);
  EXPECT_EQ(held.requests, 0u);
  EXPECT_EQ(held.builds + held.hits, 0u);
  EXPECT_EQ(held.evictedTwice, 0);

  const Hovering tight = hovering({.budgetBytes = threshold.bytes}, kSteps, true);
  print("budget of both sides, neither", kSteps, tight);
  EXPECT_EQ(tight.requests, 0u);
  EXPECT_EQ(tight.evicted, 0u);
  EXPECT_EQ(tight.builds + tight.hits, 0u);

  const Hovering graceful = hovering({.budgetBytes = tooLittle, .grace = 1h}, kSteps, false);
  print("a tile too little, grace", kSteps, graceful);
  EXPECT_EQ(graceful.requests, 0u);
  EXPECT_EQ(graceful.evictedTwice, 0) << "what neither side wants may go, once";

  const Hovering control = hovering({.budgetBytes = tooLittle}, kSteps, true);
  print("control, a tile too little, neither", kSteps, control);
  EXPECT_GE(control.requests, kSteps / 2u);
  EXPECT_GE(control.evicted, kSteps / 2u);
  EXPECT_GT(control.evictedTwice, 0);
  EXPECT_EQ(control.builds, 0u) << "the server has them";
  EXPECT_EQ(control.hits, control.requests);

  constexpr int kForgetfulSteps = 40;
  const Hovering forgetful = hover(GetParam(), threshold, {.budgetBytes = tooLittle}, kForgetfulSteps, true, 0);
  print("control, and a server without a cache", kForgetfulSteps, forgetful);
  EXPECT_GE(forgetful.builds, kForgetfulSteps / 2u);
}

TEST_P(LevelThreshold, FromTheFirstRequestOnEveryTileIsAskedForAndBuiltOnce) {
  const MoonServer server(GetParam(), kServerCache);
  const Threshold threshold = findThreshold(server.url());
  const MoonServer fresh(GetParam(), kServerCache);
  Viewer viewer(fresh.url(), 2 * threshold.bytes, 500ms, true);
  for (int step = 0; step < kSteps; ++step) viewer.frame(step % 2 == 0 ? threshold.above : threshold.below);
  viewer.settle(threshold.below);
  const TileCacheStats cache = fresh.cache();
  const StreamStatus status = viewer.status();
  std::printf("%llu requests, %llu builds, %llu evictions for %zu tiles on both sides\n",
              static_cast<unsigned long long>(status.requests), static_cast<unsigned long long>(cache.builds),
              static_cast<unsigned long long>(status.evicted), threshold.tiles);
  EXPECT_EQ(status.requests, cache.builds + 1) << "and the scene";
  EXPECT_EQ(cache.hits, 0u) << "a tile that was asked for twice";
  EXPECT_EQ(cache.builds, cache.entries) << "a tile that was built twice";
}

INSTANTIATE_TEST_SUITE_P(Schemes, LevelThreshold, test::bothSchemes(), test::nameOfScheme);

}  // namespace
}  // namespace terrane

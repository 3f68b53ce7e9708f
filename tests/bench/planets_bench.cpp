// How the work on several bodies is best shared out: one thread a body, which builds that body's tiles coarsest first,
// or one pool of a worker a processor, which builds all bodies' tiles coarsest first as the server does. Turn about in
// one run. Usage: bench_planets [--rounds N] [--scene NAME]; prints a Markdown table of medians.
//
// idle: the share of the processors' time, until the last tile was there, for which no tile was being built: at each
// moment as many processors are busy as tiles are under way, but no more than there are.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "common/memory/heap_policy.h"
#include "common/view/body_frames.h"
#include "server/scenes/scene_file.h"
#include "server/store/worker_pool.h"
#include "tests/support/require.h"
#include "tests/support/tile_source.h"

namespace {

using namespace terrane;
using Clock = std::chrono::steady_clock;

constexpr double kDegree = std::numbers::pi / 180;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// A body with the tiles that a view needs of it, coarsest first.
struct Work {
  std::unique_ptr<TileSource> source;
  std::vector<FacePath> tiles;
};

/// Where a view's camera is: over which body, and how.
struct View {
  std::string_view name, over;
  ViewPose pose;
};

std::vector<Work> workOf(const Scene& scene, const View& view) {
  const auto over = std::ranges::find(scene.bodies, view.over, &Body::name);
  const Camera camera = cameraFromPose(view.pose, over->radiusMeters, 50 * kDegree, 1280, 720);
  std::vector<Work> all;
  for (const Body& body : scene.bodies) {
    Work work{std::make_unique<TileSource>(body), {}};
    const Camera there = cameraOverOther(camera, over->positionScene, body.positionScene, body.radiusMeters);
    for (const WantedTile& wanted : work.source->settle(there, {}).wanted) work.tiles.push_back(wanted.path);
    std::ranges::stable_sort(work.tiles, {}, &FacePath::level);
    if (!work.tiles.empty()) all.push_back(std::move(work));
  }
  return all;
}

unsigned processors() { return std::max(1u, std::thread::hardware_concurrency()); }

/// When what was built, milliseconds from the start. built from any thread, the rest when nothing runs any more.
class Progress {
 public:
  double now() const { return std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }
  void built(const FacePath& tile, double beganMs) {
    const double ended = now();
    const std::lock_guard lock(mutex_);
    builds_.push_back({beganMs, ended, tile.level() == 0});
  }
  double wallMs() const { return std::ranges::max(builds_, {}, &Build::ended).ended; }
  /// When the last of all bodies had its coarsest tiles.
  double lastFirstPictureMs() const {
    double last = 0;
    for (const Build& build : builds_)
      if (build.root) last = std::max(last, build.ended);
    return last;
  }
  double idleShare() const {
    std::vector<std::pair<double, int>> changes;  // of how many are under way
    for (const Build& build : builds_) changes.insert(changes.end(), {{build.began, 1}, {build.ended, -1}});
    std::ranges::sort(changes);
    double busyMs = 0, since = 0;
    int underWay = 0;
    for (const auto& [time, change] : changes) {
      busyMs += (time - since) * std::min<double>(underWay, processors());
      underWay += change;
      since = time;
    }
    return 1 - busyMs / (processors() * wallMs());
  }

 private:
  struct Build {
    double began, ended;
    bool root;  ///< of its body's first picture
  };
  const Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::vector<Build> builds_;
};

struct Times {
  std::vector<double> wall, firstPictures, idle;
  void add(const Progress& progress) {
    wall.push_back(progress.wallMs());
    firstPictures.push_back(progress.lastFirstPictureMs());
    idle.push_back(progress.idleShare());
  }
};

void buildOne(const Work& work, const FacePath& tile, Progress& progress) {
  const double began = progress.now();
  if (!work.source->builder().build(tile)) std::exit(1);
  progress.built(tile, began);
}

void byThreadABody(const std::vector<Work>& work, Times& times) {
  Progress progress;
  std::vector<std::thread> threads;
  for (std::size_t body = 0; body < work.size(); ++body)
    threads.emplace_back([&, body] {
      for (const FacePath& tile : work[body].tiles) buildOne(work[body], tile, progress);
    });
  for (std::thread& thread : threads) thread.join();
  times.add(progress);
}

void byTile(const std::vector<Work>& work, Times& times) {
  Progress progress;
  std::size_t count = 0;
  for (const Work& body : work) count += body.tiles.size();
  std::atomic<std::size_t> left{count};
  std::promise<void> done;
  WorkerPool pool(static_cast<int>(processors()), count);
  for (std::size_t body = 0; body < work.size(); ++body)
    for (const FacePath& tile : work[body].tiles)
      pool.post(-tile.level(), [&, body, tile] {
        buildOne(work[body], tile, progress);
        if (left.fetch_sub(1) == 1) done.set_value();
      });
  done.get_future().wait();
  pool.stop();
  times.add(progress);
}

void measure(const Scene& scene, const View& view, int rounds) {
  const std::vector<Work> work = workOf(scene, view);
  Times threads, tiles;
  for (int round = -1; round < rounds; ++round) {
    Times unused;  // the first round warms caches
    byThreadABody(work, round < 0 ? unused : threads);
    byTile(work, round < 0 ? unused : tiles);
  }
  std::vector<double> ratios;
  for (std::size_t i = 0; i < tiles.wall.size(); ++i) ratios.push_back(tiles.wall[i] / threads.wall[i]);
  std::string counts;
  for (const Work& body : work) counts += fmt::format("{}{}", counts.empty() ? "" : ", ", body.tiles.size());
  fmt::print("| {} | {} | {:.0f} ({:.0f} %) | {:.0f} ({:.0f} %) | {:.2f} | {:.1f} | {:.1f} |\n", view.name, counts,
             median(threads.wall), 100 * median(threads.idle), median(tiles.wall), 100 * median(tiles.idle),
             median(ratios), median(threads.firstPictures), median(tiles.firstPictures));
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 15;
  std::string sceneName = "planets";
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view flag = argv[i];
    if (flag == "--rounds") rounds = std::max(1, std::atoi(argv[i + 1]));
    if (flag == "--scene") sceneName = argv[i + 1];
  }
  keepFreedMemory(kHeapKeptByServer);
  const Scene scene = require(loadScene(sceneName));
  const std::string first = scene.bodies.front().name, last = scene.bodies.back().name;
  fmt::print(
      "| view | tiles of each body | a thread a body, ms (idle) | by tile, ms (idle) | ratio | last body's first "
      "picture, "
      "a thread a body, ms | the same, by tile, ms |\n|---|---|---|---|---|---|---|\n");
  measure(scene, {"all bodies, from 2,400 km over the first", first, {0, 0, 2.4e6, 90 * kDegree, -25 * kDegree}},
          rounds);
  measure(scene, {"20 m over the last", last, {-40 * kDegree, 30 * kDegree, 20, 240 * kDegree, -5 * kDegree}}, rounds);
  fmt::print("\nMedians of {} rounds in turn; {} processors; ratio pair by pair.\n", rounds, processors());
}

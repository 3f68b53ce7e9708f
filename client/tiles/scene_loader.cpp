#include "client/tiles/scene_loader.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "proto/tile_url.h"

namespace terrane {

using std::chrono::milliseconds;

namespace {
constexpr double kBeforeAllTiles = -1e9;
}

struct SceneLoader::State : std::enable_shared_from_this<State> {
  State(FetchQueue& queue, DiskCache* disk, TilePipeline& pool, const PipelineOptions& chosen,
        std::function<void()> onNews)
      : fetch(queue),
        cache(disk),
        workers(pool),
        options(chosen),
        wake(std::move(onNews)),
        cacheKey(queue.origin() + std::string(kSceneTarget)) {}

  /// Parsing and the disk are no work for the network thread.
  void request(milliseconds delay) {
    fetch.fetch(
        std::string(kSceneTarget), kBeforeAllTiles,
        [self = shared_from_this()](FetchResponse response) {
          self->workers.post(
              [self, answer = std::make_shared<FetchResponse>(std::move(response))] { self->onResponse(*answer); });
        },
        delay);
  }

  void onResponse(const FetchResponse& response) {
    std::string problem;
    if (response.status == 200) {
      const std::string_view text(reinterpret_cast<const char*>(response.body.data()), response.body.size());
      auto scene = readSceneJson(text);
      if (scene) return deliver(std::move(*scene), response.body);
      problem = scene.error().text();
    } else if (response.status != 0) {
      problem = "the server answers " + std::to_string(response.status);
    } else if (response.error.kind != ErrorKind::Io && response.error.kind != ErrorKind::Timeout) {
      problem = response.error.text();
    }
    offerCached();
    const bool queueHolds = response.status == 0 && !fetch.status().reachable;
    milliseconds delay{0};
    {
      const std::lock_guard lock(mutex);
      trouble = problem.empty() ? "" : fetch.origin() + std::string(kSceneTarget) + ": " + problem;
      const int doublings = std::min(failures++, 16);
      if (!queueHolds)
        delay =
            std::max(response.retryAfter, std::min(options.longestBackoff, options.firstBackoff * (1 << doublings)));
    }
    request(delay);
    wake();
  }

  void deliver(SceneInfo scene, const std::vector<std::uint8_t>& text) {
    {
      const std::lock_guard lock(mutex);
      if (!lastScene || lastText != text) {
        lastText = text;
        lastScene = std::make_shared<const SceneInfo>(std::move(scene));
      }
      arrival = {lastScene, false};
      delivered = true;
      loading = false;
      failures = 0;
      trouble.clear();
    }
    wake();
    if (cache) cache->put(cacheKey, text, DiskCache::Keep::Always);
  }

  void offerCached() {
    if (!cache) return;
    {
      const std::lock_guard lock(mutex);
      if (std::exchange(delivered, true)) return;
    }
    const auto content = cache->get(cacheKey);
    if (!content) return withdraw();
    auto scene = readSceneJson({reinterpret_cast<const char*>(content->data()), content->size()});
    if (!scene) {
      cache->remove(cacheKey);
      return withdraw();
    }
    {
      const std::lock_guard lock(mutex);
      if (arrival.scene || !loading) return;  // the server's own came meanwhile
      arrival = {std::make_shared<const SceneInfo>(std::move(*scene)), true};
    }
    wake();
  }

  void withdraw() {
    const std::lock_guard lock(mutex);
    if (loading && !arrival.scene) delivered = false;
  }

  FetchQueue& fetch;
  DiskCache* const cache;
  TilePipeline& workers;
  const PipelineOptions options;
  const std::function<void()> wake;
  const std::string cacheKey;

  mutable std::mutex mutex;
  bool loading = false;
  bool delivered = false;  ///< a scene, from wherever, has been offered
  int failures = 0;
  Arrival arrival;
  std::vector<std::uint8_t> lastText;  ///< the server's last, and what it says
  std::shared_ptr<const SceneInfo> lastScene;
  std::string trouble;
};

SceneLoader::SceneLoader(FetchQueue& fetch, DiskCache* cache, TilePipeline& workers, const PipelineOptions& options,
                         std::function<void()> wake)
    : state_(std::make_shared<State>(fetch, cache, workers, options, std::move(wake))) {}
SceneLoader::~SceneLoader() = default;

void SceneLoader::load(milliseconds delay) {
  {
    const std::lock_guard lock(state_->mutex);
    if (std::exchange(state_->loading, true)) return;
  }
  state_->request(delay);
}

void SceneLoader::offerCached() {
  state_->workers.post([state = state_] { state->offerCached(); });
}

SceneLoader::Arrival SceneLoader::take() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->arrival, {});
}

bool SceneLoader::loading() const {
  const std::lock_guard lock(state_->mutex);
  return state_->loading;
}

std::string SceneLoader::trouble() const {
  const std::lock_guard lock(state_->mutex);
  return state_->trouble;
}

}  // namespace terrane

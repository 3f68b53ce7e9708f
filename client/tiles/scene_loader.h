#pragma once
// Brings scene.json: from the server, again and again with growing pauses until it is there; meanwhile, if the server
// does not answer, from the disk cache. Thread-safe.

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "client/net/fetch_queue.h"
#include "client/tiles/disk_cache.h"
#include "client/tiles/tile_pipeline.h"
#include "proto/scene_json.h"

namespace terrane {

class SceneLoader {
 public:
  /// cache may be null. wake is called when a scene has come or could not be had.
  SceneLoader(FetchQueue& fetch, DiskCache* cache, TilePipeline& workers, const PipelineOptions& options,
              std::function<void()> wake);
  ~SceneLoader();

  /// Begins to load, if it is not loading already.
  void load(std::chrono::milliseconds delay = {});
  /// The server takes long: if nothing has come yet, offer what the disk has.
  void offerCached();

  struct Arrival {
    std::shared_ptr<const SceneInfo> scene;  ///< null if none came; the same as before if it says the same
    bool fromCache = false;
  };
  Arrival take();

  bool loading() const;
  /// Why the last answer was no scene; empty after one that was, or when there was no answer at all.
  std::string trouble() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace terrane

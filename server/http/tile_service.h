#pragma once
// Requests to responses, apart from sockets: routes, statuses, headers, problem+json (RFC 9457). A response that must
// wait for a build comes through the callback. Thread-safe.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/scene/scene.h"
#include "proto/scene_json.h"
#include "server/build/tile_builder.h"
#include "server/store/tile_cache.h"

namespace terrane {

enum class HttpMethod : std::uint8_t { Get, Head, Options, Other };

struct ServiceRequest {
  HttpMethod method = HttpMethod::Get;
  std::string_view target;       ///< as it was sent
  std::string_view ifNoneMatch;  ///< all such fields, joined by commas
};

/// Either a tile, with its head ready made (CachedTile::head), or a small document.
struct ServiceResponse {
  int status = 200;
  std::string_view contentType;  ///< a constant
  std::string body;              ///< small documents
  CachedTilePtr tile;            ///< or a tile, sent without a copy; status is 200
  std::string etag;
  std::string_view cacheControl;  ///< a constant
  std::string_view allow;         ///< a constant
  int retryAfterSeconds = 0;
  bool preflight = false;  ///< says what other origins may do
};

/// The status line and headers, without Date, Connection and the blank line. bodyBytes: Content-Length (none for 204
/// and 304).
std::string responseHead(const ServiceResponse& response, std::size_t bodyBytes);

/// A problem+json response. instance: the request's target.
ServiceResponse problemResponse(const Error& error, int status, std::string_view instance,
                                std::string_view revision = {});

/// A tile with its strong ETag (XXH3-128 of the bytes) and its head.
CachedTilePtr makeCachedTile(std::vector<std::uint8_t> glb);

/// RFC 9110 section 13.1.2, weak comparison: whether If-None-Match names the entity tag, alone, in a list or as "*".
bool matchesEntityTag(std::string_view ifNoneMatch, std::string_view etag) noexcept;

class TileService {
 public:
  struct Options {
    std::size_t memoryCacheBytes = 256u << 20;
    int threads = 0;  ///< builders; 0: one for each hardware thread
    std::size_t maxQueuedBuilds = 4096;
    SimdPath simd = SimdPath::Default;
    DracoCoder draco = DracoCoder::Fast;
    WireSettings wire;
  };
  /// Makes the bytes of a tile of scene.bodies[key.bodyIndex]; called from the workers.
  using BuildTile = std::function<Result<std::vector<std::uint8_t>>(const TileKey&)>;

  /// Serves what the scene's builders make. Ready at once.
  TileService(const Scene& scene, const Options& options);
  /// Serves what a function makes.
  TileService(const SceneInfo& scene, BuildTile build, const Options& options);
  ~TileService();
  TileService(const TileService&) = delete;
  TileService& operator=(const TileService&) = delete;

  using Reply = std::function<void(ServiceResponse)>;
  /// Calls reply exactly once, in this thread or from a worker, unless the ticket is dropped first: keep what it
  /// returns until then; dropping it withdraws the request.
  [[nodiscard]] std::unique_ptr<TileCache::Ticket> handle(const ServiceRequest& request, Reply reply);

  /// What /readyz says: 503 until ready, and again while the server stops.
  void setReady(bool ready);
  TileCacheStats cacheStats() const;
  const SceneInfo& scene() const noexcept;
  /// Of each body: TileBuilder::whyStockDraco. None where a function makes the tiles.
  const std::vector<std::string>& whyStockDraco() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace terrane

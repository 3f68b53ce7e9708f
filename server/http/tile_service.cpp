#include "server/http/tile_service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <thread>
#include <utility>

#include "proto/tile_url.h"
#include "server/http/metrics.h"
#include "server/http/problem.h"
#include "server/http/root_page.h"

namespace terrane {
namespace {

constexpr std::string_view kTileType = "model/gltf-binary";
constexpr std::string_view kJsonType = "application/json";
constexpr std::string_view kProblemType = "application/problem+json";
constexpr std::string_view kHtmlType = "text/html; charset=utf-8";
constexpr std::string_view kTextType = "text/plain; charset=utf-8";

constexpr std::string_view kForEver = "public, max-age=31536000, immutable";
constexpr std::string_view kForAWhile = "public, max-age=10";
constexpr std::string_view kNotKept = "no-store";

constexpr std::string_view kAllow = "GET, HEAD, OPTIONS";

std::string entityTag(const void* bytes, std::size_t size) {
  const XXH128_hash_t hash = XXH3_128bits(bytes, size);
  return fmt::format("\"{:016x}{:016x}\"", hash.high64, hash.low64);
}

ServiceResponse notModified(std::string_view etag, std::string_view cacheControl) {
  ServiceResponse response;
  response.status = 304;
  response.etag = etag;
  response.cacheControl = cacheControl;
  return response;
}

ServiceResponse tileResponse(CachedTilePtr tile, std::string_view ifNoneMatch) {
  if (!ifNoneMatch.empty() && matchesEntityTag(ifNoneMatch, tile->etag)) return notModified(tile->etag, kForEver);
  ServiceResponse response;
  response.tile = std::move(tile);
  return response;
}

/// A document that was written once, with its entity tag.
struct Document {
  std::string text;
  std::string etag;
  std::string_view contentType;
  std::string_view cacheControl;

  Document(std::string body, std::string_view type, std::string_view cache)
      : text(std::move(body)), etag(entityTag(text.data(), text.size())), contentType(type), cacheControl(cache) {}

  ServiceResponse response(std::string_view ifNoneMatch) const {
    if (!ifNoneMatch.empty() && matchesEntityTag(ifNoneMatch, etag)) return notModified(etag, cacheControl);
    ServiceResponse response;
    response.contentType = contentType;
    response.body = text;
    response.etag = etag;
    response.cacheControl = cacheControl;
    return response;
  }
};

ServiceResponse plainText(std::string_view text) {
  ServiceResponse response;
  response.contentType = kTextType;
  response.body = text;
  response.cacheControl = kNotKept;
  return response;
}

int workerThreads(int wanted) {
  return wanted > 0 ? wanted : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace

std::string responseHead(const ServiceResponse& response, std::size_t bodyBytes) {
  std::string head;
  head.reserve(384);
  const auto out = std::back_inserter(head);
  fmt::format_to(out, "HTTP/1.1 {} {}\r\nServer: terrane\r\nAccess-Control-Allow-Origin: *\r\n", response.status,
                 reasonPhrase(response.status));
  const auto field = [&](std::string_view name, std::string_view value) {
    if (!value.empty()) head.append(name).append(": ").append(value).append("\r\n");
  };
  field("Content-Type", response.contentType);
  if (response.status != 204 && response.status != 304) fmt::format_to(out, "Content-Length: {}\r\n", bodyBytes);
  field("Cache-Control", response.cacheControl);
  field("ETag", response.etag);
  if (!response.etag.empty()) field("Access-Control-Expose-Headers", "ETag");
  field("Allow", response.allow);
  if (response.retryAfterSeconds > 0)
    fmt::format_to(out, "Retry-After: {}\r\nAccess-Control-Expose-Headers: Retry-After\r\n",
                   response.retryAfterSeconds);
  if (response.preflight) {
    field("Access-Control-Allow-Methods", kAllow);
    field("Access-Control-Allow-Headers", "If-None-Match, Cache-Control, Range");
    field("Access-Control-Max-Age", "86400");
  }
  field("X-Content-Type-Options", response.contentType.empty() ? "" : "nosniff");
  return head;
}

ServiceResponse problemResponse(const Error& error, int status, std::string_view instance, std::string_view revision) {
  ServiceResponse response;
  response.status = status;
  response.contentType = kProblemType;
  response.body = problemJson(error, status, instance, revision);
  response.cacheControl = kNotKept;
  if (status == 405) response.allow = kAllow;
  if (status == 503) response.retryAfterSeconds = 1;
  return response;
}

CachedTilePtr makeCachedTile(std::vector<std::uint8_t> glb) {
  auto tile = std::make_shared<CachedTile>();
  tile->glb = std::move(glb);
  tile->etag = entityTag(tile->glb.data(), tile->glb.size());
  ServiceResponse response;
  response.contentType = kTileType;
  response.cacheControl = kForEver;
  response.etag = tile->etag;
  tile->head = responseHead(response, tile->glb.size());
  return tile;
}

bool matchesEntityTag(std::string_view ifNoneMatch, std::string_view etag) noexcept {
  for (std::size_t i = 0; i < ifNoneMatch.size();) {
    const char c = ifNoneMatch[i];
    if (c == ' ' || c == '\t' || c == ',') {
      ++i;
      continue;
    }
    if (c == '*') return true;
    if (ifNoneMatch.substr(i).starts_with("W/")) i += 2;
    if (i >= ifNoneMatch.size() || ifNoneMatch[i] != '"') return false;  // not a list of entity tags
    const std::size_t end = ifNoneMatch.find('"', i + 1);
    if (end == std::string_view::npos) return false;
    if (ifNoneMatch.substr(i, end + 1 - i) == etag) return true;
    i = end + 1;
  }
  return false;
}

struct TileService::State {
  State(SceneInfo info, BuildTile buildTile, const Options& options)
      : scene(std::move(info)),
        build(std::move(buildTile)),
        sceneJson(writeSceneJson(scene), kJsonType, kForAWhile),
        page(rootPage(scene), kHtmlType, kForAWhile),
        workers(workerThreads(options.threads), options.maxQueuedBuilds),
        cache(options.memoryCacheBytes, workers, [this](const TileKey& key) { return buildCached(key); }) {}

  Result<CachedTilePtr> buildCached(const TileKey& key) const {
    Result<std::vector<std::uint8_t>> glb = build(key);
    if (!glb) return std::move(glb).error();
    return makeCachedTile(*std::move(glb));
  }

  Result<TileKey> findTile(const TileAddress& address, std::string& currentRevision) const;
  ServiceResponse answer(const Route& route, const ServiceRequest& request) const;

  // What the workers use outlives them: cache and pool come last and go first.
  const SceneInfo scene;
  const BuildTile build;
  const Document sceneJson, page;
  std::vector<std::string> whyStockDraco;
  std::atomic<bool> ready{true};
  WorkerPool workers;
  TileCache cache;
};

/// Errors: NotFound naming "body", "scheme" or "digits"; Gone, with the revision that is current.
Result<TileKey> TileService::State::findTile(const TileAddress& address, std::string& currentRevision) const {
  const auto body = std::ranges::find(scene.bodies, address.body, &BodyInfo::name);
  if (body == scene.bodies.end())
    return makeError(ErrorKind::NotFound, "body", fmt::format("this scene has no body \"{}\"", address.body));
  if (address.revision != body->revision) {
    currentRevision = body->revision;
    return makeError(ErrorKind::Gone, "revision",
                     fmt::format("the current revision of \"{}\" is {}", body->name, body->revision));
  }
  if (std::ranges::count(body->schemes, address.path.scheme()) == 0)
    return makeError(ErrorKind::NotFound, "scheme",
                     fmt::format("\"{}\" is not tiled by \"{}\"", body->name, schemeName(address.path.scheme())));
  if (address.path.level() > body->selection.maxLevel)
    return makeError(ErrorKind::NotFound, "digits",
                     fmt::format("{} digits, but the finest level of \"{}\" is {}", address.path.level(), body->name,
                                 body->selection.maxLevel));
  return TileKey{static_cast<std::uint32_t>(body - scene.bodies.begin()), address.path};
}

/// Every route but the tiles.
ServiceResponse TileService::State::answer(const Route& route, const ServiceRequest& request) const {
  if (std::holds_alternative<RootPage>(route)) return page.response(request.ifNoneMatch);
  if (std::holds_alternative<SceneDocument>(route)) return sceneJson.response(request.ifNoneMatch);
  if (std::holds_alternative<HealthCheck>(route)) return plainText("ok\n");
  if (std::holds_alternative<Metrics>(route)) {
    ServiceResponse response = plainText(metricsText(cache.stats(), scene.bodies, whyStockDraco));
    response.contentType = kMetricsType;
    return response;
  }
  if (ready) return plainText("ready\n");
  return problemResponse(makeError(ErrorKind::Overloaded, "", "the server is not ready"), 503, request.target);
}

TileService::TileService(const SceneInfo& scene, BuildTile build, const Options& options)
    : state_(std::make_unique<State>(scene, std::move(build), options)) {}

TileService::TileService(const Scene& scene, const Options& options) {
  auto builders = std::make_shared<std::vector<TileBuilder>>();
  SceneInfo info{scene.name, scene.summary, {}, scene.effects};
  std::vector<std::string> whyStockDraco;
  for (const Body& body : scene.bodies) {
    builders->emplace_back(body, options.wire, options.simd, options.draco);
    whyStockDraco.push_back(builders->back().whyStockDraco());
    info.bodies.push_back(builders->back().info());
  }
  BuildTile build = [builders](const TileKey& key) -> Result<std::vector<std::uint8_t>> {
    Result<BuiltTile> built = (*builders)[key.bodyIndex].build(key.path);
    if (!built) return std::move(built).error();
    spdlog::debug("built {}: field {:.2f} ms, mesh {:.2f} ms, draco {:.2f} ms, glb {:.2f} ms, {} bytes",
                  key.path.text(), built->times.fieldMs, built->times.meshMs, built->times.dracoMs, built->times.glbMs,
                  built->glb.size());
    return std::move(built->glb);
  };
  state_ = std::make_unique<State>(std::move(info), std::move(build), options);
  state_->whyStockDraco = std::move(whyStockDraco);
}

TileService::~TileService() = default;

std::unique_ptr<TileCache::Ticket> TileService::handle(const ServiceRequest& request, Reply reply) {
  const auto refuse = [&](const Error& error, int status, std::string_view revision = {}) {
    reply(problemResponse(error, status, request.target, revision));
    return nullptr;
  };
  if (request.method == HttpMethod::Other)
    return refuse(makeError(ErrorKind::InvalidArgument, "method", "allowed: GET, HEAD, OPTIONS"), 405);
  if (request.method == HttpMethod::Options) {
    ServiceResponse response;
    response.status = 204;
    response.allow = kAllow;
    response.preflight = true;
    reply(std::move(response));
    return nullptr;
  }
  const Result<Route> route = parseTarget(request.target);
  if (!route) return refuse(route.error(), httpStatus(route.error()));
  const TileAddress* address = std::get_if<TileAddress>(&*route);
  if (!address) {
    reply(state_->answer(*route, request));
    return nullptr;
  }
  std::string currentRevision;
  const Result<TileKey> key = state_->findTile(*address, currentRevision);
  if (!key) return refuse(key.error(), httpStatus(key.error()), currentRevision);
  if (CachedTilePtr tile = state_->cache.find(*key)) {
    reply(tileResponse(std::move(tile), request.ifNoneMatch));
    return nullptr;
  }
  return state_->cache.getOrBuild(*key, [reply = std::move(reply), target = std::string(request.target),
                                         ifNoneMatch = std::string(request.ifNoneMatch)](Result<CachedTilePtr> tile) {
    if (tile) return reply(tileResponse(*std::move(tile), ifNoneMatch));
    if (tile.error().kind == ErrorKind::Internal) spdlog::error("{}: {}", target, tile.error().text());
    reply(problemResponse(tile.error(), httpStatus(tile.error()), target));
  });
}

void TileService::setReady(bool ready) { state_->ready = ready; }

TileCacheStats TileService::cacheStats() const { return state_->cache.stats(); }

const SceneInfo& TileService::scene() const noexcept { return state_->scene; }

const std::vector<std::string>& TileService::whyStockDraco() const noexcept { return state_->whyStockDraco; }

}  // namespace terrane

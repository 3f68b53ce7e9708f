#include "server/http/tile_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

namespace terrane {
namespace {

using testing::HasSubstr;

constexpr std::string_view kRevision = "0123456789abcdef";

SceneInfo threeBodies() {
  SceneInfo scene{"test", "A <test> & more", {}, {}};
  for (const char* name : {"moon", "rock", "ball"}) {
    BodyInfo body;
    body.name = name;
    body.revision = kRevision;
    body.selection.scheme = body.name == "ball" ? Scheme::Ico : Scheme::Cube;
    body.schemes = {body.selection.scheme};
    body.selection.radiusMeters = 1737400;
    body.selection.maxLevel = 12;
    for (int level = 0; level <= 12; ++level) body.selection.geometricErrorMeters.push_back(4096.0 / (1 << level));
    scene.bodies.push_back(body);
  }
  return scene;
}

class TileServiceTest : public testing::Test {
 protected:
  void make(TileService::BuildTile build, TileService::Options options = {}) {
    options.threads = 1;
    service.emplace(threeBodies(), std::move(build), options);
  }
  /// The tile's bytes are its body and path.
  void makePlain() {
    make([this](const TileKey& key) -> Result<std::vector<std::uint8_t>> {
      ++builds;
      const std::string text = std::to_string(key.bodyIndex) + ":" + key.path.text();
      return std::vector<std::uint8_t>(text.begin(), text.end());
    });
  }
  ServiceResponse ask(std::string_view target, std::string_view ifNoneMatch = {}, HttpMethod method = HttpMethod::Get) {
    const auto answer = std::make_shared<std::promise<ServiceResponse>>();  // shared with the worker that gives it
    const auto ticket = service->handle({method, target, ifNoneMatch},
                                        [answer](ServiceResponse response) { answer->set_value(std::move(response)); });
    return answer->get_future().get();
  }
  static std::string tile(std::string_view rest) {
    return "/v1/" + std::string(kRevision) + "/" + std::string(rest) + ".glb";
  }

  std::atomic<int> builds{0};
  std::optional<TileService> service;
};

TEST_F(TileServiceTest, ATileIsItsBytesWithAHeadThatEveryCacheUnderstands) {
  makePlain();
  const ServiceResponse response = ask(tile("rock/cube/2/03"));
  ASSERT_EQ(response.status, 200);
  ASSERT_NE(response.tile, nullptr);
  EXPECT_EQ(std::string(response.tile->glb.begin(), response.tile->glb.end()), "1:cube/2/03");
  const std::string& head = response.tile->head;
  EXPECT_THAT(head, testing::StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(head, HasSubstr("Content-Type: model/gltf-binary\r\n"));
  EXPECT_THAT(head, HasSubstr("Content-Length: 11\r\n"));
  EXPECT_THAT(head, HasSubstr("Cache-Control: public, max-age=31536000, immutable\r\n"));
  EXPECT_THAT(head, HasSubstr("Access-Control-Allow-Origin: *\r\n"));
  EXPECT_THAT(head, HasSubstr("Access-Control-Expose-Headers: ETag\r\n"));
  EXPECT_THAT(head, HasSubstr("ETag: " + response.tile->etag + "\r\n"));
  EXPECT_THAT(response.tile->etag, testing::MatchesRegex("\"[0-9a-f]{32}\""));
}

TEST_F(TileServiceTest, TheEntityTagFollowsTheBytesAlone) {
  EXPECT_EQ(makeCachedTile({1, 2, 3})->etag, makeCachedTile({1, 2, 3})->etag);
  EXPECT_NE(makeCachedTile({1, 2, 3})->etag, makeCachedTile({1, 2, 4})->etag);
}

TEST_F(TileServiceTest, ATileIsBuiltOnceForGetHeadAndConditionalRequests) {
  makePlain();
  const std::string etag = ask(tile("moon/cube/0")).tile->etag;
  EXPECT_EQ(ask(tile("moon/cube/0"), {}, HttpMethod::Head).status, 200);
  const ServiceResponse notModified = ask(tile("moon/cube/0"), etag);
  EXPECT_EQ(notModified.status, 304);
  EXPECT_EQ(notModified.etag, etag);
  EXPECT_EQ(notModified.tile, nullptr);
  EXPECT_EQ(notModified.cacheControl, "public, max-age=31536000, immutable");
  EXPECT_EQ(builds, 1);
  EXPECT_EQ(ask(tile("moon/cube/1"), "*").status, 304) << "a tile that exists, though nobody has built it yet";
}

TEST(EntityTag, IfNoneMatchIsAListAWeakTagOrAStar) {
  const std::string_view etag = "\"abc\"";
  for (const std::string_view match :
       {"\"abc\"", "W/\"abc\"", "*", "\"x\", \"abc\"", "\"x\",W/\"abc\" , \"y\"", " \"abc\" ", ",, \"abc\""})
    EXPECT_TRUE(matchesEntityTag(match, etag)) << match;
  for (const std::string_view other :
       {"", "\"\"", "abc", "\"abd\"", "\"x\", \"y\"", "\"ab", "W/", "W/abc", "\"ABC\"", "x\"abc\"", "\"a,b\""})
    EXPECT_FALSE(matchesEntityTag(other, etag)) << other;
}

TEST_F(TileServiceTest, EveryBadTileAddressNamesItsPartAndBuildsNothing) {
  makePlain();
  struct Case {
    std::string target;
    int status;
    std::string_view field;
  };
  const std::string digits31(31, '0');
  const std::vector<Case> cases{
      {tile("moon/cube/6/0"), 400, "face"},
      {tile("moon/cube/-1/0"), 400, "face"},
      {tile("moon/cube/1/4"), 400, "digits"},
      {tile("moon/cube/1/" + digits31), 400, "digits"},
      {tile("moon/cube/1/0123012301230"), 404, "digits"},
      {tile("mars/cube/1"), 404, "body"},
      {tile("moon/ico/1"), 404, "scheme"},
      {tile("ball/cube/1"), 404, "scheme"},
      {tile("ball/ico/20"), 400, "face"},
      {tile("ball/ico/19/4"), 400, "digits"},
      {tile("ball/ico/19/0123012301230"), 404, "digits"},
      {tile("moon/tetra/1"), 400, "scheme"},
      {"/v1/%00", 400, "target"},
      {"/v1/" + std::string(3000, 'a'), 414, "target"},
      {"/nope", 404, "target"},
      {"", 400, "target"},
      {"v1/scene.json", 400, "target"},
  };
  for (const Case& c : cases) {
    const ServiceResponse response = ask(c.target);
    EXPECT_EQ(response.status, c.status) << c.target.substr(0, 80) << "\n" << response.body;
    EXPECT_EQ(response.contentType, "application/problem+json");
    EXPECT_THAT(response.body, HasSubstr("\"field\":\"" + std::string(c.field) + "\"")) << c.target.substr(0, 80);
    EXPECT_EQ(response.cacheControl, "no-store");
    EXPECT_EQ(response.tile, nullptr);
  }
  EXPECT_EQ(builds, 0);
}

TEST_F(TileServiceTest, AllFacesAndDigitsOfABodyOnTheIcosahedronAreServed) {
  makePlain();
  for (int face = 0; face < 20; ++face) {
    const std::string path = "ico/" + std::to_string(face);
    for (const std::string& digits : {std::string(), std::string("/0123"), std::string("/333333333333")}) {
      const ServiceResponse response = ask(tile("ball/" + path + digits));
      ASSERT_EQ(response.status, 200) << response.body;
      EXPECT_EQ(std::string(response.tile->glb.begin(), response.tile->glb.end()), "2:" + path + digits);
    }
  }
}

TEST_F(TileServiceTest, TheFinestLevelIsServedAndTheNextIsNot) {
  makePlain();
  EXPECT_EQ(ask(tile("moon/cube/1/012301230123")).status, 200);
  EXPECT_EQ(ask(tile("moon/cube/1/0123012301230")).status, 404);
}

TEST_F(TileServiceTest, AnOldRevisionIsGoneAndTheAnswerHoldsTheCurrentOne) {
  makePlain();
  const ServiceResponse response = ask("/v1/fedcba9876543210/moon/cube/1.glb");
  EXPECT_EQ(response.status, 410);
  EXPECT_THAT(response.body, HasSubstr("\"revision\":\"0123456789abcdef\""));
  EXPECT_THAT(response.body, HasSubstr("\"field\":\"revision\""));
}

TEST_F(TileServiceTest, OtherMethodsAreNotAllowedAndOptionsSaysWhatIs) {
  makePlain();
  const ServiceResponse refused = ask(tile("moon/cube/0"), {}, HttpMethod::Other);
  EXPECT_EQ(refused.status, 405);
  EXPECT_EQ(refused.allow, "GET, HEAD, OPTIONS");
  const ServiceResponse options = ask("*", {}, HttpMethod::Options);
  EXPECT_EQ(options.status, 204);
  EXPECT_TRUE(options.preflight);
  const std::string head = responseHead(options, 0);
  EXPECT_THAT(head, HasSubstr("Access-Control-Allow-Methods: GET, HEAD, OPTIONS\r\n"));
  EXPECT_THAT(head, HasSubstr("Access-Control-Allow-Origin: *\r\n"));
  EXPECT_THAT(head, testing::Not(HasSubstr("Content-Length")));
}

TEST_F(TileServiceTest, SceneJsonIsTheSceneAndCanBeRevalidated) {
  makePlain();
  const ServiceResponse response = ask("/v1/scene.json");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.contentType, "application/json");
  EXPECT_EQ(response.cacheControl, "public, max-age=10");
  const Result<SceneInfo> scene = readSceneJson(response.body);
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->bodies.at(1).name, "rock");
  EXPECT_EQ(scene->bodies.at(1).revision, kRevision);
  EXPECT_EQ(ask("/v1/scene.json", response.etag).status, 304);
}

TEST_F(TileServiceTest, TheRootPageEscapesWhatTheSceneSays) {
  makePlain();
  const ServiceResponse page = ask("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.contentType, "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("A &lt;test&gt; &amp; more"));
  EXPECT_THAT(page.body, HasSubstr("/v1/0123456789abcdef/rock/cube/5.glb"));
  EXPECT_THAT(page.body, HasSubstr("/v1/0123456789abcdef/ball/ico/19.glb"));
  EXPECT_THAT(page.body, testing::Not(HasSubstr("/ball/cube/")));
  EXPECT_THAT(page.body, HasSubstr("terrane-view --server"));
}

TEST_F(TileServiceTest, HealthIsAlwaysGoodAndReadinessFollowsTheSwitch) {
  makePlain();
  EXPECT_EQ(ask("/healthz").status, 200);
  EXPECT_EQ(ask("/readyz").status, 200);
  service->setReady(false);
  EXPECT_EQ(ask("/healthz").status, 200);
  const ServiceResponse notReady = ask("/readyz");
  EXPECT_EQ(notReady.status, 503);
  EXPECT_EQ(notReady.retryAfterSeconds, 1);
}

TEST_F(TileServiceTest, MetricsCountWhatWasAsked) {
  makePlain();
  ask(tile("moon/cube/0"));
  ask(tile("moon/cube/0"));
  const ServiceResponse metrics = ask("/metrics");
  EXPECT_EQ(metrics.status, 200);
  EXPECT_THAT(std::string(metrics.contentType), testing::StartsWith("text/plain; version=0.0.4"));
  EXPECT_EQ(metrics.cacheControl, "no-store");
  EXPECT_THAT(metrics.body, HasSubstr("\nterrane_tile_hits_total 1\n"));
  EXPECT_THAT(metrics.body, HasSubstr("\nterrane_tile_builds_total 1\n"));
  EXPECT_THAT(metrics.body, HasSubstr("\n# TYPE terrane_tile_memory_bytes gauge\n"));
  EXPECT_THAT(metrics.body, testing::EndsWith("\n"));
}

TEST_F(TileServiceTest, ABuildThatFailsOrThrowsIsAnInternalErrorAndTheNextRequestTriesAgain) {
  int calls = 0;
  make([&](const TileKey&) -> Result<std::vector<std::uint8_t>> {
    if (++calls == 1) return makeError(ErrorKind::Internal, "", "broken");
    if (calls == 2) throw std::runtime_error("thrown by a test");
    return std::vector<std::uint8_t>{1};
  });
  EXPECT_EQ(ask(tile("moon/cube/0")).status, 500);
  EXPECT_EQ(ask(tile("moon/cube/0")).status, 500);
  EXPECT_EQ(ask(tile("moon/cube/0")).status, 200);
}

TEST_F(TileServiceTest, AFullQueueAsksTheClientToComeBack) {
  std::promise<void> building, release;
  TileService::Options options;
  options.maxQueuedBuilds = 1;
  make(
      [&, first = true](const TileKey&) mutable -> Result<std::vector<std::uint8_t>> {
        if (std::exchange(first, false)) {
          building.set_value();
          release.get_future().wait();
        }
        return std::vector<std::uint8_t>{1};
      },
      options);
  const auto ignore = [](const ServiceResponse&) {};
  const std::string a = tile("moon/cube/0"), b = tile("moon/cube/1");
  const auto running = service->handle({HttpMethod::Get, a, {}}, ignore);
  building.get_future().wait();
  const auto queued = service->handle({HttpMethod::Get, b, {}}, ignore);
  const ServiceResponse refused = ask(tile("moon/cube/2"));
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(refused.retryAfterSeconds, 1);
  EXPECT_THAT(responseHead(refused, refused.body.size()), HasSubstr("Retry-After: 1\r\n"));
  release.set_value();
  EXPECT_EQ(ask(b).status, 200);
}

}  // namespace
}  // namespace terrane

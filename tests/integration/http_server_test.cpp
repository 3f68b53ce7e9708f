// The HTTP server over real loopback sockets, with builds that a test holds and releases.
#include "server/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "tests/integration/http_client.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using test::HttpAnswer;
using test::HttpConnection;
using test::httpGet;
using testing::HasSubstr;

constexpr std::string_view kRevision = "0123456789abcdef";

std::string tileAt(std::string_view rest) {
  return "/v1/" + std::string(kRevision) + "/moon/" + std::string(rest) + ".glb";
}

std::string longTarget(std::size_t bytes) {
  std::string target(bytes, 'a');
  target[0] = '/';
  return target;
}

SceneInfo oneBody() {
  SceneInfo scene{"test", "A test", {}, {}};
  BodyInfo body;
  body.name = "moon";
  body.revision = kRevision;
  body.schemes = {Scheme::Cube};
  body.selection.radiusMeters = 1737400;
  body.selection.maxLevel = 20;
  scene.bodies.push_back(body);
  return scene;
}

/// A server in this process. Tiles are the text of their path, or `tileBytes` bytes of it again and again.
class HttpServerTest : public testing::Test {
 protected:
  void SetUp() override { options.listen = {"127.0.0.1:0"}; }
  void TearDown() override {
    release();
    stop();
  }

  void start() {
    TileService::Options serviceOptions;
    serviceOptions.threads = 1;
    service.emplace(
        oneBody(), [this](const TileKey& key) { return build(key); }, serviceOptions);
    auto opened = HttpServer::open(options, *service);
    ASSERT_TRUE(opened) << opened.error().text();
    server = *std::move(opened);
    url = server->urls().at(0);
    thread = std::thread([this] { server->run(); });
  }
  void stop() {
    if (!thread.joinable()) return;
    server->stop();
    thread.join();
  }

  Result<std::vector<std::uint8_t>> build(const TileKey& key) {
    std::unique_lock lock(mutex);
    ++buildsBegun;
    changed.notify_all();
    changed.wait(lock, [this] { return !held; });
    const std::string text = key.path.text();
    std::vector<std::uint8_t> bytes(std::max(tileBytes, text.size()));
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(text[i % text.size()]);
    return bytes;
  }
  void hold() {
    const std::lock_guard lock(mutex);
    held = true;
  }
  void release() {
    const std::lock_guard lock(mutex);
    held = false;
    changed.notify_all();
  }
  void waitForBuilds(int count) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return buildsBegun >= count; });
  }
  /// Waits for something that will come to pass, at most half a minute.
  template <class Condition>
  static bool eventually(Condition condition) {
    for (int i = 0; i < 6000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(5ms);
    }
    return false;
  }
  void expectStillServing() {
    const auto answer = httpGet(url, "/healthz");
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
  }

  ServerOptions options;
  std::size_t tileBytes = 0;
  std::optional<TileService> service;
  std::unique_ptr<HttpServer> server;
  std::string url;
  std::thread thread;

  std::mutex mutex;
  std::condition_variable changed;
  bool held = false;
  int buildsBegun = 0;
};

TEST_F(HttpServerTest, ATileArrivesWithItsHeaders) {
  start();
  const auto answer = httpGet(url, tileAt("cube/2/0312"));
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->body, "cube/2/0312");
  EXPECT_EQ(answer->fields.at("content-type"), "model/gltf-binary");
  EXPECT_EQ(answer->fields.at("cache-control"), "public, max-age=31536000, immutable");
  EXPECT_EQ(answer->fields.at("access-control-allow-origin"), "*");
  EXPECT_THAT(answer->fields.at("date"), testing::EndsWith(" GMT"));
  EXPECT_EQ(answer->fields.count("connection"), 0u) << "HTTP/1.1 keeps connections";
}

TEST_F(HttpServerTest, OneConnectionServesManyRequestsOfAllKinds) {
  start();
  HttpConnection connection(url);
  std::string etag;
  for (int i = 0; i < 50; ++i) {
    const auto tile = connection.request(tileAt("cube/" + std::to_string(i % 6)));
    ASSERT_TRUE(tile) << i;
    EXPECT_EQ(tile->body, "cube/" + std::to_string(i % 6));
    const auto head = connection.request(tileAt("cube/1"), "HEAD");
    ASSERT_TRUE(head) << i;
    EXPECT_EQ(head->fields.at("content-length"), "6");
    etag = head->fields.at("etag");
    const auto unchanged =
        connection.request(tileAt("cube/1"), "GET", "If-None-Match: \"x\"\r\nIf-None-Match: W/" + etag + "\r\n");
    ASSERT_TRUE(unchanged) << i;
    EXPECT_EQ(unchanged->status, 304);
    EXPECT_EQ(unchanged->fields.at("etag"), etag);
    EXPECT_EQ(unchanged->fields.count("content-length"), 0u);
    EXPECT_EQ(connection.request(tileAt("cube/6"))->status, 400) << "an error keeps the connection";
    EXPECT_EQ(connection.request("/", "OPTIONS")->status, 204);
  }
  EXPECT_EQ(service->cacheStats().builds, 6u);
}

TEST_F(HttpServerTest, PipelinedRequestsAreAnsweredInTheirOrder) {
  start();
  HttpConnection connection(url);
  std::string requests;
  constexpr int kRequests = 300;
  for (int i = 0; i < kRequests; ++i)
    requests += "GET " + tileAt("cube/" + std::to_string(i % 6)) + " HTTP/1.1\r\nHost: x\r\n\r\n";
  std::thread sender([&] { connection.send(requests); });
  for (int i = 0; i < kRequests; ++i) {
    const auto answer = connection.read();
    ASSERT_TRUE(answer) << i;
    ASSERT_EQ(answer->body, "cube/" + std::to_string(i % 6)) << i;
  }
  sender.join();
}

TEST_F(HttpServerTest, ARequestThatArrivesByteByByteIsARequest) {
  start();
  HttpConnection connection(url);
  for (const char c : "GET " + tileAt("cube/3") + " HTTP/1.1\r\nHost: x\r\n\r\n")
    connection.send(std::string_view(&c, 1));
  EXPECT_EQ(connection.read()->body, "cube/3");
}

TEST_F(HttpServerTest, EveryBadRequestGetsItsStatusWithCorsAndTheServerStaysUp) {
  start();
  struct Case {
    std::string request;
    int status;
    std::string field;  // of the problem document
  };
  const auto get = [](const std::string& target) { return "GET " + target + " HTTP/1.1\r\nHost: x\r\n\r\n"; };
  const std::vector<Case> cases{
      {get(tileAt("cube/6/0")), 400, "face"},
      {get(tileAt("cube/1/4")), 400, "digits"},
      {get(tileAt("cube/1/" + std::string(31, '0'))), 400, "digits"},
      {get(tileAt("cube/1/" + std::string(21, '0'))), 404, "digits"},
      {get("/v1/%00"), 400, "target"},
      {get("/v1/" + std::string(kRevision) + "/moon/cube/1%00.glb"), 400, "target"},
      {get("/../../etc/passwd"), 400, "target"},
      {get(longTarget(3000)), 414, "target"},
      {get(longTarget(10000)), 414, "target"},
      {get(longTarget(100000)), 414, "target"},
      {"GET / HTTP/1.1\r\nHost: x\r\nX: " + std::string(10000, 'a') + "\r\n\r\n", 431, "header"},
      {"DELETE / HTTP/1.1\r\nHost: x\r\n\r\n", 405, "method"},
      {"POST " + tileAt("cube/1") + " HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\nabc", 405, "method"},
      {"BREW / HTTP/1.1\r\nHost: x\r\n\r\n", 405, "method"},
      {"GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\nabc", 413, "body"},
      {"GET / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n", 413, "body"},
      {"GET / HTTP/1.1\r\n\r\n", 400, "Host"},
      {"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", 400, "Host"},
      {"GET / HTTP/2.0\r\nHost: x\r\n\r\n", 505, "version"},
      {"GET / HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\nContent-Length: 4\r\n\r\n", 400, "header"},
      {"GET / HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\n\r\n", 400, "header"},
      {"GET / HTTP/1.1\nHost: x\n\n", 400, "header"},
      {"GET /a b HTTP/1.1\r\nHost: x\r\n\r\n", 400, "header"},
      {"GET /\r\nHost: x\r\n\r\n", 400, "header"},
      {"nonsense\r\n\r\n", 400, "header"},
      {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11), 400, "header"},  // a browser that tries TLS
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.request.substr(0, 80));
    HttpConnection connection(url);
    connection.send(c.request);
    const auto answer = connection.read();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, c.status) << answer->body;
    EXPECT_EQ(answer->fields.at("content-type"), "application/problem+json");
    EXPECT_EQ(answer->fields.at("access-control-allow-origin"), "*");
    EXPECT_THAT(answer->body, HasSubstr("\"field\":\"" + c.field + "\""));
    expectStillServing();
  }
  EXPECT_EQ(service->cacheStats().builds, 0u);
}

TEST_F(HttpServerTest, ManySmallHeaderFieldsAreBoundedToo) {
  start();
  HttpConnection connection(url);
  std::string header = "GET / HTTP/1.1\r\nHost: x\r\n";
  for (int i = 0; i < 2000; ++i) header += "X-Field: y\r\n";
  connection.send(header);
  EXPECT_EQ(connection.read()->status, 431);
}

TEST_F(HttpServerTest, CorsIsOnForEveryKindOfAnswer) {
  start();
  for (const auto& [method, target] : {std::pair{"GET", std::string("/")},
                                       {"GET", "/v1/scene.json"},
                                       {"GET", "/healthz"},
                                       {"GET", "/nope"},
                                       {"GET", tileAt("cube/0")},
                                       {"HEAD", tileAt("cube/0")},
                                       {"OPTIONS", tileAt("cube/0")},
                                       {"PUT", "/"}}) {
    HttpConnection connection(url);
    const auto answer = connection.request(target, method, "Origin: http://elsewhere.example\r\n");
    ASSERT_TRUE(answer) << method << target;
    EXPECT_EQ(answer->fields.at("access-control-allow-origin"), "*") << method << target;
  }
}

TEST_F(HttpServerTest, HalfARequestThenSilenceEndsWith408) {
  options.headerTimeout = 100ms;
  start();
  HttpConnection connection(url);
  connection.send("GET / HTTP/1.1\r\nHos");
  const auto answer = connection.read();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 408);
  EXPECT_EQ(answer->fields.at("connection"), "close");
  EXPECT_TRUE(connection.closedByServer());
  expectStillServing();
}

TEST_F(HttpServerTest, AHeaderThatTricklesInDoesNotExtendItsTime) {
  options.headerTimeout = 200ms;
  start();
  HttpConnection connection(url);
  connection.send("GET / HTTP/1.1\r\n");
  std::atomic<bool> done{false};
  std::thread trickle([&] {
    while (!done) {
      connection.send("X: y\r\n");
      std::this_thread::sleep_for(20ms);
    }
  });
  const auto answer = connection.read();
  done = true;
  trickle.join();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 408);
}

TEST_F(HttpServerTest, ASilentConnectionAndAnIdleOneAreClosed) {
  options.headerTimeout = 100ms;
  options.idleTimeout = 100ms;
  start();
  HttpConnection silent(url), idle(url);
  EXPECT_EQ(idle.request("/healthz")->status, 200);
  EXPECT_TRUE(silent.closedByServer());
  EXPECT_TRUE(idle.closedByServer());
  EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
}

TEST_F(HttpServerTest, Http10ClosesUnlessItAsksToKeep) {
  start();
  HttpConnection closing(url), keeping(url);
  closing.send("GET /healthz HTTP/1.0\r\n\r\n");
  EXPECT_EQ(closing.read()->fields.at("connection"), "close");
  EXPECT_TRUE(closing.closedByServer());
  for (int i = 0; i < 2; ++i) {
    keeping.send("GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
    EXPECT_EQ(keeping.read()->fields.at("connection"), "keep-alive");
  }
}

TEST_F(HttpServerTest, ConnectionCloseIsHonoured) {
  start();
  HttpConnection connection(url);
  const auto answer = connection.request(tileAt("cube/0"), "GET", "Connection: close\r\n");
  EXPECT_EQ(answer->fields.at("connection"), "close");
  EXPECT_EQ(answer->body, "cube/0");
  EXPECT_TRUE(connection.closedByServer());
}

TEST_F(HttpServerTest, AProxysAbsoluteTargetAndDoubledSlashesAreRead) {
  start();
  EXPECT_EQ(httpGet(url, "http://example.org" + tileAt("cube/0"))->body, "cube/0");
  EXPECT_EQ(httpGet(url, std::string("/") + tileAt("cube/0"))->body, "cube/0");
}

TEST_F(HttpServerTest, ServesIpv6AndSeveralListeners) {
  if (!test::ipv6LoopbackExists()) GTEST_SKIP() << "this machine has no ::1";
  options.listen = {"127.0.0.1:0", "[::1]:0"};
  start();
  const std::vector<std::string> urls = server->urls();
  ASSERT_EQ(urls.size(), 2u);
  EXPECT_THAT(urls[0], testing::MatchesRegex("http://127\\.0\\.0\\.1:[0-9]+"));
  EXPECT_THAT(urls[1], testing::MatchesRegex("http://\\[::1\\]:[0-9]+"));
  for (const std::string& each : urls) EXPECT_EQ(httpGet(each, tileAt("cube/4"))->body, "cube/4");
}

TEST_F(HttpServerTest, APortInUseAndABadAddressNameTheFlag) {
  start();
  ServerOptions second;
  second.listen = {url.substr(7)};
  const auto taken = HttpServer::open(second, *service);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().kind, ErrorKind::Io);
  EXPECT_EQ(taken.error().field, "--listen");
  EXPECT_THAT(taken.error().message, HasSubstr(url.substr(7)));
  for (const char* bad : {"nowhere", "127.0.0.1:99999", "no.such.host.invalid:80"}) {
    second.listen = {bad};
    const auto refused = HttpServer::open(second, *service);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().field, "--listen") << bad;
  }
}

TEST_F(HttpServerTest, ABuildUnderWayDoesNotKeepOthersWaiting) {
  start();
  hold();
  HttpConnection waiting(url);
  waiting.send("GET " + tileAt("cube/0/1") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  waitForBuilds(1);
  for (int i = 0; i < 20; ++i) expectStillServing();
  release();
  EXPECT_EQ(waiting.read()->body, "cube/0/1");
}

TEST_F(HttpServerTest, AClientThatGoesAwayWithdrawsItsBuild) {
  start();
  hold();
  HttpConnection first(url), closing(url), resetting(url), staying(url);
  first.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  waitForBuilds(1);
  closing.send("GET " + tileAt("cube/1") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  resetting.send("GET " + tileAt("cube/2") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  staying.send("GET " + tileAt("cube/3") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  ASSERT_TRUE(eventually([&] { return service->cacheStats().inFlight == 4; }));
  closing.close();
  resetting.abort();
  ASSERT_TRUE(eventually([&] { return service->cacheStats().dropped == 2; }));
  release();
  EXPECT_EQ(first.read()->body, "cube/0");
  EXPECT_EQ(staying.read()->body, "cube/3");
  EXPECT_EQ(service->cacheStats().builds, 2u);
}

TEST_F(HttpServerTest, ATileThatTakesTooLongIs503AndTheConnectionIsKept) {
  options.responseTimeout = 100ms;
  start();
  hold();
  HttpConnection connection(url);
  const auto late = connection.request(tileAt("cube/0"));
  ASSERT_TRUE(late);
  EXPECT_EQ(late->status, 503);
  EXPECT_EQ(late->fields.at("retry-after"), "1");
  release();
  EXPECT_EQ(connection.request("/healthz")->status, 200);
}

TEST_F(HttpServerTest, ConnectionsBeyondTheLimitGet503AndPlacesAreFreedAgain) {
  options.maxConnections = 3;
  start();
  {
    HttpConnection a(url), b(url), c(url);
    for (HttpConnection* connection : {&a, &b, &c}) EXPECT_EQ(connection->request("/healthz")->status, 200);
    HttpConnection fourth(url);
    const auto refused = fourth.read();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->status, 503);
    EXPECT_EQ(a.request("/healthz")->status, 200) << "the others are not disturbed";
  }
  EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
  expectStillServing();
}

TEST_F(HttpServerTest, ALargeTileArrivesWholeThoughTheClientReadsSlowly) {
  tileBytes = 12'000'000;
  start();
  HttpConnection connection(url);
  connection.send("GET " + tileAt("cube/5") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  std::this_thread::sleep_for(50ms);  // the socket's buffers fill up
  const auto answer = connection.read();
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->body.size(), tileBytes);
  const std::string pattern = "cube/5";
  for (std::size_t i = 0; i < tileBytes; i += 997) ASSERT_EQ(answer->body[i], pattern[i % pattern.size()]) << i;
  EXPECT_EQ(connection.request("/healthz")->status, 200);
}

TEST_F(HttpServerTest, AClientThatDoesNotTakeItsTileIsLetGo) {
  tileBytes = 50'000'000;
  options.writeTimeout = 150ms;
  start();
  HttpConnection connection(url);
  connection.send("GET " + tileAt("cube/5") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_TRUE(eventually([&] { return server->connections() == 1; }));
  EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
  expectStillServing();
}

TEST_F(HttpServerTest, StopLetsWhatIsUnderWayFinishAndClosesTheIdle) {
  start();
  hold();
  HttpConnection idle(url), busy(url);
  EXPECT_EQ(idle.request("/healthz")->status, 200);
  busy.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  waitForBuilds(1);
  server->stop();
  EXPECT_TRUE(idle.closedByServer());
  EXPECT_FALSE(HttpConnection(url).open()) << "nothing new is accepted";
  release();
  const auto answer = busy.read();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->body, "cube/0");
  EXPECT_EQ(answer->fields.at("connection"), "close");
  stop();
  EXPECT_EQ(server->connections(), 0u);
}

TEST_F(HttpServerTest, StopDoesNotWaitLongerThanItsGrace) {
  options.shutdownGrace = 100ms;
  start();
  hold();
  HttpConnection busy(url), half(url);
  busy.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  half.send("GET / HT");
  waitForBuilds(1);
  stop();  // returns although the build is still held
  EXPECT_EQ(server->connections(), 0u);
  EXPECT_FALSE(busy.read());
}

TEST_F(HttpServerTest, AServerThatIsStoppedBeforeItRunsReturnsAtOnce) {
  TileService::Options serviceOptions;
  service.emplace(
      oneBody(), [this](const TileKey& key) { return build(key); }, serviceOptions);
  auto opened = HttpServer::open(options, *service);
  ASSERT_TRUE(opened);
  (*opened)->stop();
  (*opened)->run();
}

TEST_F(HttpServerTest, ManyClientsOnSeveralIoThreadsGetWhatTheyAskFor) {
  options.ioThreads = 2;
  start();
  constexpr int kClients = 6, kRequests = 60;
  std::vector<std::thread> clients;
  for (int c = 0; c < kClients; ++c)
    clients.emplace_back([&, c] {
      std::optional<HttpConnection> connection;
      for (int i = 0; i < kRequests; ++i) {
        if (i % 10 == 0) connection.emplace(url);
        const std::string path = "cube/" + std::to_string((c + i) % 6) + "/0" + std::to_string(i % 4);
        const auto answer = connection->request(tileAt(path));
        ASSERT_TRUE(answer) << path;
        ASSERT_EQ(answer->body, path);
      }
    });
  for (std::thread& client : clients) client.join();
  EXPECT_LE(service->cacheStats().builds, 24u) << "no tile is built twice";
}

}  // namespace
}  // namespace terrane

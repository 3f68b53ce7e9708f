// What is asked over a connection, whole or in pieces, once or many times, is answered over it.
#include "server/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/http_server_fixture.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace test;
using testing::HasSubstr;

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

TEST_F(HttpServerTest, AFewEmptyLinesBeforeARequestAreNothing) {
  start();
  HttpConnection connection(url);
  for (const char* lines : {"\r\n", "\r\n\r\n", "\r\n\r\n\r\n\r\n", ""}) {
    connection.send(lines + ("GET " + tileAt("cube/3") + " HTTP/1.1\r\nHost: x\r\n\r\n"));
    EXPECT_EQ(connection.read()->body, "cube/3") << lines;
  }
  for (const char c : "\r\nGET " + tileAt("cube/2") + " HTTP/1.1\r\nHost: x\r\n\r\n")
    connection.send(std::string_view(&c, 1));
  EXPECT_EQ(connection.read()->body, "cube/2");
  connection.send("\r\n\r\n\r\n\r\n\r\nGET / HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_EQ(connection.read()->status, 400) << "many are no request";
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
  gate.hold();
  HttpConnection waiting(url);
  waiting.send("GET " + tileAt("cube/0/1") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  gate.waitForBuilds(1);
  for (int i = 0; i < 20; ++i) expectStillServing();
  gate.release();
  EXPECT_EQ(waiting.read()->body, "cube/0/1");
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

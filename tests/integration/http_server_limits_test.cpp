// No client keeps the server waiting beyond its time limits, and none takes more than its place.
#include "server/http/http_server.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "tests/integration/http_server_fixture.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace test;

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

TEST_F(HttpServerTest, AClientThatGoesAwayWithdrawsItsBuild) {
  start();
  gate.hold();
  HttpConnection first(url), closing(url), resetting(url), staying(url);
  first.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  gate.waitForBuilds(1);
  closing.send("GET " + tileAt("cube/1") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  resetting.send("GET " + tileAt("cube/2") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  staying.send("GET " + tileAt("cube/3") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  ASSERT_TRUE(eventually([&] { return service->cacheStats().inFlight == 4; }));
  closing.close();
  resetting.abort();
  ASSERT_TRUE(eventually([&] { return service->cacheStats().dropped == 2; }));
  gate.release();
  EXPECT_EQ(first.read()->body, "cube/0");
  EXPECT_EQ(staying.read()->body, "cube/3");
  EXPECT_EQ(service->cacheStats().builds, 2u);
}

TEST_F(HttpServerTest, AClientThatHasSaidAllGetsItsAnswers) {
  start();
  gate.hold();
  HttpConnection first(url), half(url), head(url), several(url), gone(url);
  first.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  gate.waitForBuilds(1);
  half.send("GET " + tileAt("cube/1") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  head.send("HEAD " + tileAt("cube/2") + " HTTP/1.0\r\n\r\n");
  several.send("GET " + tileAt("cube/3") + " HTTP/1.1\r\nHost: x\r\n\r\nGET " + tileAt("cube/4") +
               " HTTP/1.1\r\nHost: x\r\n\r\n");
  gone.send("GET " + tileAt("cube/5") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  for (HttpConnection* connection : {&half, &head, &several, &gone}) connection->shutdownSend();
  ASSERT_TRUE(eventually([&] { return service->cacheStats().inFlight == 5; }));
  gone.close();
  ASSERT_TRUE(eventually([&] { return service->cacheStats().dropped == 1; })) << "half closed first, then gone";
  gate.release();
  EXPECT_EQ(half.read()->body, "cube/1");
  EXPECT_EQ(head.read(false)->fields.at("content-length"), "6");
  EXPECT_EQ(several.read()->body, "cube/3");
  EXPECT_EQ(several.read()->body, "cube/4");
  for (HttpConnection* connection : {&half, &head, &several}) EXPECT_TRUE(connection->closedByServer());
  first.close();
  EXPECT_TRUE(eventually([&] { return server->connections() == 0; }));
}

TEST_F(HttpServerTest, AClientThatHasSaidAllIsToldWhenItsTileTakesTooLong) {
  options.responseTimeout = 100ms;
  start();
  gate.hold();
  HttpConnection connection(url);
  connection.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  connection.shutdownSend();
  EXPECT_EQ(connection.read()->status, 503);
  EXPECT_TRUE(connection.closedByServer());
}

TEST_F(HttpServerTest, EmptyLinesDoNotKeepAConnection) {
  options.headerTimeout = 200ms;
  options.idleTimeout = 200ms;
  start();
  HttpConnection fresh(url), used(url), half(url);
  EXPECT_EQ(used.request("/healthz")->status, 200);
  fresh.send("\r\n");
  used.send("\r\n\r\n");
  half.send("\r");
  for (HttpConnection* connection : {&fresh, &used, &half}) EXPECT_TRUE(connection->closedByServer());
}

TEST_F(HttpServerTest, ATileThatTakesTooLongIs503AndTheConnectionIsKept) {
  options.responseTimeout = 100ms;
  start();
  gate.hold();
  HttpConnection connection(url);
  const auto late = connection.request(tileAt("cube/0"));
  ASSERT_TRUE(late);
  EXPECT_EQ(late->status, 503);
  EXPECT_EQ(late->fields.at("retry-after"), "1");
  gate.release();
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

}  // namespace
}  // namespace terrane

// Stopping: what is under way may finish, what is idle goes, and nothing takes longer than its grace.
#include "server/http/http_server.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/integration/http_server_fixture.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace test;

TEST_F(HttpServerTest, StopLetsWhatIsUnderWayFinishAndClosesTheIdle) {
  start();
  gate.hold();
  HttpConnection idle(url), busy(url);
  EXPECT_EQ(idle.request("/healthz")->status, 200);
  busy.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  gate.waitForBuilds(1);
  server->stop();
  EXPECT_TRUE(idle.closedByServer());
  EXPECT_FALSE(HttpConnection(url).open()) << "nothing new is accepted";
  gate.release();
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
  gate.hold();
  HttpConnection busy(url), half(url);
  busy.send("GET " + tileAt("cube/0") + " HTTP/1.1\r\nHost: x\r\n\r\n");
  half.send("GET / HT");
  gate.waitForBuilds(1);
  stop();  // returns although the build is still held
  EXPECT_EQ(server->connections(), 0u);
  EXPECT_FALSE(busy.read());
}

TEST_F(HttpServerTest, AServerThatIsStoppedBeforeItRunsReturnsAtOnce) {
  makeService({});
  auto opened = HttpServer::open(options, *service);
  ASSERT_TRUE(opened);
  (*opened)->stop();
  (*opened)->run();
}

}  // namespace
}  // namespace terrane

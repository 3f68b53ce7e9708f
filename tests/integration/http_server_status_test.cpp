// Every kind of request, bad ones above all, gets the status and the header fields that it must.
#include "server/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/integration/http_server_fixture.h"

namespace terrane {
namespace {

using namespace test;
using testing::HasSubstr;

std::string longTarget(std::size_t bytes) {
  std::string target(bytes, 'a');
  target[0] = '/';
  return target;
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

}  // namespace
}  // namespace terrane

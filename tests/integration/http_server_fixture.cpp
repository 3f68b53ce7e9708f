#include "tests/integration/http_server_fixture.h"

#include <algorithm>

namespace terrane::test {
namespace {

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

}  // namespace

std::string tileAt(std::string_view rest) {
  return "/v1/" + std::string(kRevision) + "/moon/" + std::string(rest) + ".glb";
}

void HttpServerTest::SetUp() { options.listen = {"127.0.0.1:0"}; }

void HttpServerTest::TearDown() {
  gate.release();
  stop();
}

void HttpServerTest::makeService(const TileService::Options& serviceOptions) {
  service.emplace(
      oneBody(), [this](const TileKey& key) { return build(key); }, serviceOptions);
}

void HttpServerTest::start() {
  TileService::Options serviceOptions;
  serviceOptions.threads = 1;
  makeService(serviceOptions);
  auto opened = HttpServer::open(options, *service);
  ASSERT_TRUE(opened) << opened.error().text();
  server = *std::move(opened);
  url = server->urls().at(0);
  thread_ = std::thread([this] { server->run(); });
}

void HttpServerTest::stop() {
  if (!thread_.joinable()) return;
  server->stop();
  thread_.join();
}

void HttpServerTest::expectStillServing() {
  const auto answer = httpGet(url, "/healthz");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
}

Result<std::vector<std::uint8_t>> HttpServerTest::build(const TileKey& key) {
  gate.pass();
  const std::string text = key.path.text();
  std::vector<std::uint8_t> bytes(std::max(tileBytes, text.size()));
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(text[i % text.size()]);
  return bytes;
}

}  // namespace terrane::test

#pragma once
// A server in the test's own process, over real loopback sockets, with builds that the test holds and releases.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/http/http_server.h"
#include "tests/integration/http_client.h"
#include "tests/support/build_gate.h"

namespace terrane::test {

inline constexpr std::string_view kRevision = "0123456789abcdef";

/// The target of a tile of the one body that is served: "cube/2/0312".
std::string tileAt(std::string_view rest);

/// Tiles are the text of their path, or `tileBytes` bytes of it again and again.
class HttpServerTest : public testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// start() does this itself; alone it serves a test that opens its own server.
  void makeService(const TileService::Options& serviceOptions);
  void start();
  void stop();

  /// Waits for something that will come to pass, at most half a minute.
  template <class Condition>
  static bool eventually(Condition condition) {
    for (int i = 0; i < 6000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  void expectStillServing();

  ServerOptions options;
  std::size_t tileBytes = 0;
  testing_support::BuildGate gate;
  std::optional<TileService> service;
  std::unique_ptr<HttpServer> server;
  std::string url;

 private:
  Result<std::vector<std::uint8_t>> build(const TileKey& key);

  std::thread thread_;
};

}  // namespace terrane::test

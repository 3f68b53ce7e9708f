// The viewer when the server is not there, dies, is no Terrane server, or is far away.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <gtest/gtest.h>

#include <thread>

#include "proto/scene_json.h"
#include "tests/support/view_processes.h"

namespace terrane {
namespace {

using namespace testing_support;
using namespace std::chrono_literals;

/// A loopback port: listening and silent, or free at the time of asking.
class Port {
 public:
  explicit Port(bool listening) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0) return;
    if (listening && ::listen(socket_, 16) != 0) return;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    url_ = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  ~Port() { ::close(socket_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  const std::string& url() const { return url_; }
  int socket() const { return socket_; }

 private:
  int socket_;
  std::string url_;
};

/// Answers whatever it is asked with the same text.
class SameAnswer {
 public:
  explicit SameAnswer(const std::string& body)
      : answer_("HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
                body),
        thread_([this] { serve(); }) {}
  ~SameAnswer() {
    ::shutdown(port_.socket(), SHUT_RDWR);
    thread_.join();
  }
  const std::string& url() const { return port_.url(); }

 private:
  void serve() {
    for (int client = -1; (client = ::accept(port_.socket(), nullptr, nullptr)) >= 0; ::close(client)) {
      char request[4096];
      if (::recv(client, request, sizeof request, 0) > 0) ::send(client, answer_.data(), answer_.size(), MSG_NOSIGNAL);
    }
  }

  Port port_{true};
  std::string answer_;
  std::thread thread_;
};

void expectOneLineNamingTheServer(const ViewOutcome& outcome) {
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(lineCount(outcome.errors), 1u) << outcome.errors;
  EXPECT_NE(outcome.errors.find("--server"), std::string::npos) << outcome.errors;
}

TEST(BadNetwork, ADeadServerEndsAScriptedRunWithOneLineAfterTheTimeLimit) {
  const Port port(false);  // bound, so that nobody else listens there, but not listening
  expectOneLineNamingTheServer(
      runView({"--server", port.url(), "--headless", "--size", "64x36", "--time-limit", "2"}, 60s));
}

TEST(BadNetwork, AServerThatNeverAnswersEndsAScriptedRunToo) {
  const Port port(true);
  expectOneLineNamingTheServer(
      runView({"--server", port.url(), "--headless", "--size", "64x36", "--time-limit", "2"}, 60s));
}

TEST(BadNetwork, ABadSceneIsTheServersAndSaysWhatIsWrong) {
  const SameAnswer server(R"({"name": "x", "summary": "", "bodies": 7})");
  const auto outcome = runView({"--server", server.url(), "--headless", "--size", "64x36", "--time-limit", "1"}, 60s);
  expectOneLineNamingTheServer(outcome);
  EXPECT_EQ(outcome.errors.find("--time-limit"), std::string::npos) << outcome.errors;
  EXPECT_NE(outcome.errors.find("/v1/scene.json: bodies"), std::string::npos) << outcome.errors;
}

TEST(BadNetwork, AnUnknownEffectIsNamedOnceAndNoReasonToStop) {
  SceneInfo scene{"x", "", {}, {}};
  scene.bodies.push_back({"moon", "0123456789abcdef", {Scheme::Cube}, 64, {}, {}});
  scene.bodies[0].selection.radiusMeters = scene.bodies[0].selection.occluderRadiusMeters = 1000;
  scene.bodies[0].selection.geometricErrorMeters = {1000};
  std::string text = writeSceneJson(scene);
  const std::string effects = R"("effects": [)";
  ASSERT_NE(text.find(effects), std::string::npos) << text;
  text.insert(text.find(effects) + effects.size(), R"({"name":"aurora"},{"name":"\u001b[31m"},{"name":"aurora"})");
  const SameAnswer server(text);
  // Nothing but the scene can be had here, so something else ends the run.
  const auto outcome = runView({"--server", server.url(), "--headless", "--size", "64x36", "--body", "mars"}, 60s);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(lineCount(outcome.errors), 3u) << outcome.errors;
  EXPECT_EQ(outcome.errors.find("\"aurora\""), outcome.errors.rfind("\"aurora\"")) << outcome.errors;
  EXPECT_NE(outcome.errors.find("warning: the scene has the effect \"aurora\""), std::string::npos) << outcome.errors;
  EXPECT_NE(outcome.errors.find("\"\\x1b[31m\""), std::string::npos) << outcome.errors;
  EXPECT_NE(outcome.errors.find("--body: "), std::string::npos) << outcome.errors;
}

TEST(BadNetwork, AStreamingFlightOverALongThinLineShowsNoHole) {
  const RunningServer server("moon");
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const TemporaryFolder folder;
  std::ofstream(folder / "f.txt")
      << "# terrane flight 1\nabove-ground\n0 -16.4 21.6 3000000 0 -90\n10 -16.4 21.6 20 40 -30\n";
  const std::vector<std::string> flight{"--server", server.url, "--headless",     "--size",
                                        "320x180",  "--flight", folder / "f.txt", "--step",
                                        "0.1",      "--stats",  folder / "s.json"};
  std::vector<std::string> slow = flight;
  slow.insert(slow.end(), {"--latency", "150", "--bandwidth", "1MB/s"});
  const auto outcome = runView(slow);
  std::printf("%s", outcome.output.c_str());
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  const std::string json = readFile(folder / "s.json");
  EXPECT_EQ(jsonNumber(json, "latencyMs"), 150);
  EXPECT_EQ(jsonNumber(json, "bandwidthBytesPerSecond"), 1e6);
  EXPECT_EQ(jsonNumber(json, "framesDrawn"), 101);
  EXPECT_EQ(jsonNumber(json, "framesCounted"), 101);
  EXPECT_GT(jsonNumber(json, "requests"), 50) << "in ten seconds most of what it asked for has come";
  EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0);
  EXPECT_EQ(jsonNumber(json, "skirtPixels"), 0);
  EXPECT_GE(jsonNumber(json, "msToSettle"), 300) << "the scene, then the first tiles: two latencies at least";
  ASSERT_EQ(runView(flight).status, 0);
  EXPECT_EQ(readFile(folder / "s.json").find("latencyMs"), std::string::npos) << "a network as it is has no figures";
}

TEST(BadNetwork, ANonsenseServerUrlIsRefused) {
  const auto outcome = runView({"--server", "http://", "--headless", "--size", "64x36", "--time-limit", "2"}, 60s);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(lineCount(outcome.errors), 1u) << outcome.errors;
  EXPECT_NE(outcome.errors.find("--server"), std::string::npos) << outcome.errors;
}

TEST(BadNetwork, AServerThatDiesInFlightLeavesTheViewerDrawingToTheEnd) {
  RunningServer server("moon");
  ASSERT_FALSE(server.url.empty()) << server.process->errors();
  const TemporaryFolder folder;
  // The first pose is full before the flight begins; then every frame asks for more, from a server that is gone.
  std::ofstream(folder / "f.txt")
      << "# terrane flight 1\n0 -10 8 3000000 0 -90\n1 -10 8 2999999 0 -90\n9 40 8 30000 0 -60\n";
  ChildProcess viewer({programFile("terrane-view"), "--server", server.url, "--headless", "--size", "160x90",
                       "--flight", folder / "f.txt", "--step", "0.05", "--stats", folder / "s.json"});
  ASSERT_FALSE(viewer.waitForLine("3000 km above sphere", 120s).empty()) << viewer.errors();
  server.process->kill();
  const auto status = viewer.wait(240s);
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(*status, 0) << viewer.errors();
  EXPECT_NE(viewer.output().find("does not answer"), std::string::npos) << viewer.output();
  const std::string json = readFile(folder / "s.json");
  EXPECT_EQ(jsonNumber(json, "framesDrawn"), 181);
  EXPECT_EQ(jsonNumber(json, "uncoveredPixels"), 0);  // what it has covers the body, if coarsely
}

}  // namespace
}  // namespace terrane

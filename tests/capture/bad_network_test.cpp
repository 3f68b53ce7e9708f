// The viewer when the server is not there, dies, or is no Terrane server.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <gtest/gtest.h>

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

 private:
  int socket_;
  std::string url_;
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

TEST(BadNetwork, ANonsenseServerUrlIsRefused) {
  const auto outcome = runView({"--server", "http://", "--headless", "--size", "64x36", "--time-limit", "2"}, 60s);
  EXPECT_NE(outcome.status, 0);
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

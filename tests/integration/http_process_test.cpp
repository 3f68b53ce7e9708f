// The real terrane-server: its command line, its signals, its limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "proto/scene_json.h"
#include "proto/tile_url.h"
#include "tests/integration/http_client.h"
#include "tests/integration/server_process.h"
#include "tests/support/folders.h"
#include "tests/support/sanitizers.h"

namespace terrane {
namespace {

using test::FinishedProcess;
using test::HttpConnection;
using test::runServer;
using test::ServerProcess;
using testing::HasSubstr;

bool isOneLine(const std::string& text) {
  return !text.empty() && std::ranges::count(text, '\n') == 1 && text.back() == '\n';
}

std::string tileTargetOf(const ServerProcess& server, const FacePath& path) {
  const auto answer = test::httpGet(server.url(), kSceneTarget);
  if (!answer) return {};
  const Result<SceneInfo> scene = readSceneJson(answer->body);
  return scene ? tileTarget({scene->bodies.at(0).revision, scene->bodies.at(0).name, path}) : std::string();
}

TEST(ServerProgram, SaysInOneLineWhereItServesAndServesTilesThere) {
  ServerProcess server({"--scene", "moon"});
  EXPECT_THAT(server.readyLine(),
              testing::MatchesRegex("terrane-server: serving moon on http://127\\.0\\.0\\.1:[0-9]+"));
  const auto tile = test::httpGet(server.url(), tileTargetOf(server, FacePath::wholeFace(Scheme::Cube, 2)));
  ASSERT_TRUE(tile);
  EXPECT_EQ(tile->status, 200);
  EXPECT_THAT(tile->body, testing::StartsWith("glTF"));
  EXPECT_EQ(test::httpGet(server.url(), "/readyz")->status, 200);
  EXPECT_THAT(test::httpGet(server.url(), "/")->body, HasSubstr("<h1>Terrane: moon</h1>"));
}

TEST(ServerProgram, TheSecondTimeATileIsTheSameBytesFromMemory) {
  ServerProcess server({"--scene", "moon", "--memory-cache", "8MiB", "--threads", "2"});
  const std::string target = tileTargetOf(server, FacePath::cubeTile(3, 9, 100, 200));
  const auto first = test::httpGet(server.url(), target), second = test::httpGet(server.url(), target);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->body, second->body);
  EXPECT_EQ(first->fields.at("etag"), second->fields.at("etag"));
  EXPECT_EQ(test::httpGet(server.url(), target, "If-None-Match: " + first->fields.at("etag") + "\r\n")->status, 304);
}

TEST(ServerProgram, BothCodersOfDracoServeTheSameTilesAndSayWhichTheyAre) {
  ServerProcess fast({"--scene", "moon"}), stock({"--scene", "moon", "--draco", "stock"});
  for (const FacePath& path : {FacePath::wholeFace(Scheme::Cube, 4), FacePath::cubeTile(1, 11, 700, 1500)}) {
    const auto a = test::httpGet(fast.url(), tileTargetOf(fast, path)),
               b = test::httpGet(stock.url(), tileTargetOf(stock, path));
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->status, 200);
    EXPECT_TRUE(a->body == b->body) << path.text();
  }
  EXPECT_THAT(test::httpGet(fast.url(), "/metrics")->body, HasSubstr("terrane_draco_template{body=\"moon\"} 1\n"));
  EXPECT_THAT(test::httpGet(stock.url(), "/metrics")->body, HasSubstr("terrane_draco_template{body=\"moon\"} 0\n"));
  fast.signal(SIGTERM);
  stock.signal(SIGTERM);
  EXPECT_THAT(fast.wait().standardError, HasSubstr("moon: tiles are encoded by a template learnt from libdraco"));
  EXPECT_THAT(stock.wait().standardError, HasSubstr("moon: every tile is encoded by libdraco: as told"));
}

// A client has many requests under way on one connection. What it gets before the server ends is whole, and says that
// it is the end.
TEST(ServerProgram, SigtermWhileRequestsAreUnderWayAnswersThemAndExitsWithZero) {
  for (const int number : {SIGTERM, SIGINT}) {
    ServerProcess server({"--scene", "moon", "--threads", "1"});
    const std::string target = tileTargetOf(server, FacePath::cubeTile(0, 8, 0, 0));
    HttpConnection connection(server.url());
    std::string requests;
    for (std::uint32_t column = 0; column < 200; ++column)
      requests += "GET " + tileTargetOf(server, FacePath::cubeTile(0, 8, column, 7)) + " HTTP/1.1\r\nHost: x\r\n\r\n";
    std::thread sender([&] { connection.send(requests); });
    ASSERT_TRUE(connection.read());
    server.signal(number);
    std::string lastConnection;
    while (const auto answer = connection.read()) {
      EXPECT_EQ(answer->status, 200);
      EXPECT_THAT(answer->body, testing::StartsWith("glTF"));
      const auto field = answer->fields.find("connection");
      lastConnection = field == answer->fields.end() ? "" : field->second;
    }
    sender.join();
    EXPECT_EQ(lastConnection, "close");
    const FinishedProcess end = server.wait();
    EXPECT_EQ(end.exitStatus, 0) << end.standardError;
    EXPECT_EQ(end.standardOutput, "") << "the ready line is all";
    EXPECT_THAT(end.standardError, HasSubstr("stopped after"));
  }
}

TEST(ServerProgram, ASecondSignalEndsItAtOnce) {
  ServerProcess server({"--scene", "smooth", "--shutdown-grace", "600", "--header-timeout", "600"});
  HttpConnection half(server.url());
  half.send("GET / HTTP/1.1\r\n");
  EXPECT_EQ(test::httpGet(server.url(), "/healthz")->status, 200);  // by now the half request has been read too
  server.signal(SIGTERM);
  while (HttpConnection(server.url()).open()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  server.signal(SIGTERM);
  EXPECT_EQ(server.wait().exitStatus, 1);
}

TEST(ServerProgram, APortInUseIsOneLineAndAFailure) {
  ServerProcess first({"--scene", "smooth"});
  const std::string address = first.url().substr(7);
  const FinishedProcess second = runServer({"--scene", "smooth", "--listen", address});
  EXPECT_EQ(second.exitStatus, 1);
  EXPECT_TRUE(isOneLine(second.standardError)) << second.standardError;
  EXPECT_THAT(second.standardError, HasSubstr("--listen"));
  EXPECT_THAT(second.standardError, HasSubstr(address));
  EXPECT_THAT(second.standardError, HasSubstr("in use"));
  EXPECT_EQ(second.standardOutput, "");
}

TEST(ServerProgram, ANameThatCannotBeResolvedIsOneLineAndAFailure) {
  const FinishedProcess server = runServer({"--scene", "smooth", "--listen", "192.0.2.1.7:80"});
  EXPECT_EQ(server.exitStatus, 1);
  EXPECT_TRUE(isOneLine(server.standardError)) << server.standardError;
  EXPECT_THAT(server.standardError, HasSubstr("--listen: \"192.0.2.1.7\" cannot be resolved"));
}

TEST(ServerProgram, TheStatusIsTheSameWhereNobodyCanBeTold) {
  for (const char* nowhere : {"2>&-", "2>/dev/full"}) {
    const std::string command = test::buildFolder() + "/bin/terrane-server --bogus " + std::string(nowhere);
    EXPECT_EQ(test::runProgram({"sh", "-c", command}).exitStatus, 2) << nowhere;
  }
}

TEST(ServerProgram, EveryWrongFlagIsOneLineThatNamesItAndExitsWithTwo) {
  struct Case {
    std::vector<std::string> arguments;
    std::string names;
  };
  const std::vector<Case> cases{
      {{"--bogus"}, "--bogus"},
      {{"stray"}, "stray"},
      {{"--scene"}, "--scene"},
      {{"--scene", "--check"}, "--scene: "},
      {{"--scene="}, "--scene: "},
      {{"--listen", ""}, "--listen: "},
      {{"--listen", "127.0.0.1"}, "--listen: "},
      {{"--scene", "mars"}, "moon, planets, smooth"},
      {{"--scene", "/nonexistent.toml"}, "/nonexistent.toml"},
      {{"--scene", "smooth", "--memory-cache", "12 parsecs"}, "--memory-cache"},
      {{"--scene", "smooth", "--memory-cache", "99999999999999999999MiB"}, "--memory-cache"},
      {{"--scene", "smooth", "--threads", "-1"}, "--threads"},
      {{"--scene", "smooth", "--threads", "many"}, "--threads"},
      {{"--scene", "smooth", "--io-threads", "0"}, "--io-threads"},
      {{"--scene", "smooth", "--cells", "63"}, "--cells"},
      {{"--scene", "smooth", "--simd", "v9"}, "--simd"},
      {{"--scene", "smooth", "--draco", "slow"}, "--draco"},
      {{"--scene", "smooth", "--max-header", "1"}, "--max-header"},
      {{"--scene", "smooth", "--header-timeout", "0"}, "--header-timeout"},
      {{"--scene", "smooth", "--write-timeout", "nan"}, "--write-timeout"},
      {{"--scene", "smooth", "--shutdown-grace", "inf"}, "--shutdown-grace"},
      {{"--scene", "smooth", "--log-level", "loud"}, "--log-level"},
      {{"--config", "/nonexistent.toml"}, "/nonexistent.toml"},
      {{"--check=7"}, "--check: "},
      {{"--explain=true"}, "--explain: "},
      {{"--version="}, "--version: "},
  };
  for (const Case& c : cases) {
    const FinishedProcess end = runServer(c.arguments);
    EXPECT_EQ(end.exitStatus, 2) << c.names;
    EXPECT_TRUE(isOneLine(end.standardError)) << end.standardError;
    EXPECT_THAT(end.standardError, testing::StartsWith("terrane-server: "));
    EXPECT_THAT(end.standardError, HasSubstr(c.names));
    EXPECT_EQ(end.standardOutput, "") << c.names;
  }
}

TEST(ServerProgram, HelpExplainsEveryFlag) {
  const FinishedProcess help = runServer({"--help"});
  EXPECT_EQ(help.exitStatus, 0);
  for (const char* flag : {"--scene", "--listen", "--threads", "--io-threads", "--memory-cache", "--simd", "--draco",
                           "--cells", "--config", "--check", "--explain", "--version", "--shutdown-grace"})
    EXPECT_THAT(help.standardOutput, HasSubstr(flag));
  EXPECT_THAT(help.standardOutput, HasSubstr("256MiB"));
  EXPECT_THAT(help.standardOutput, HasSubstr("Exit status"));
  EXPECT_THAT(help.standardOutput, HasSubstr("moon-ico, moon, planets, smooth"));
  const FinishedProcess version = runServer({"--version"});
  EXPECT_EQ(version.exitStatus, 0);
  EXPECT_THAT(version.standardOutput, testing::MatchesRegex("terrane-server [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(ServerProgram, AConfigurationFileSetsFlagsAndTheCommandLineWins) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("terrane-config-" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << "scene = \"smooth\"\nmemory-cache = \"1MiB\"\n";
  EXPECT_THAT(runServer({"--config", file.string(), "--check"}).standardOutput, HasSubstr("scene smooth is valid"));
  EXPECT_THAT(runServer({"--config", file.string(), "--scene", "moon", "--check"}).standardOutput,
              HasSubstr("scene moon is valid"));
  std::ofstream(file) << "scene = mars\nlisten = [\"127.0.0.1:0\", '[::1]:0']\ncheck\n";
  EXPECT_THAT(runServer({"--config", file.string(), "--scene", "moon"}).standardOutput,
              HasSubstr("scene moon is valid"));
  std::filesystem::remove(file);
}

TEST(ServerProgram, WhatIsWrongInAConfigurationFileIsOnePrintableLineWithFileLineAndFlag) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("terrane-config-" + std::to_string(getpid()) + ".toml");
  struct Case {
    std::string text, names;
  };
  for (const Case& c : {Case{"memory-cash = \"1MiB\"\n", ":1: memory-cash: "},
                        {"check = 7\n", ":1: check: \"7\""},
                        {"check\nthreads = many\n", ":2: threads: "},
                        {"threads = -1\n", ":1: threads: "},
                        {"memory-cache = 12 parsecs\n", ":1: memory-cache: \"12 parsecs\""},
                        {"simd = v9\n", ":1: simd: "},
                        {"listen = [\"127.0.0.1:0\", \"x\"]\n", ":1: listen: \"x\""},
                        {"\nscene = mars\n", ":2: scene: "},
                        {"config = other.toml\n", ":1: config: "},
                        {"help\n", ":1: help: "},
                        {std::string("\x7f\x45LF\x01\0\n\xff\x1b[31m", 13), ":2: not UTF-8"}}) {
    std::ofstream(file, std::ios::binary) << c.text;
    const FinishedProcess end = runServer({"--config", file.string(), "--check"});
    EXPECT_EQ(end.exitStatus, 2) << c.names;
    EXPECT_THAT(end.standardError, testing::StartsWith("terrane-server: " + file.string() + c.names));
    EXPECT_TRUE(isOneLine(end.standardError)) << end.standardError;
    EXPECT_TRUE(std::ranges::all_of(end.standardError, [](char b) { return b == '\n' || (b >= ' ' && b < 0x7f); }));
    EXPECT_EQ(end.standardOutput, "") << c.names;
  }
  std::filesystem::remove(file);
}

TEST(ServerProgram, CheckRefusesEveryBrokenSceneInOneLineWithFileAndLine) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::sourceFolder() + "/tests/unit/server/broken_scenes")) {
    const FinishedProcess end = runServer({"--check", "--scene", entry.path().string()});
    EXPECT_EQ(end.exitStatus, 2) << entry.path();
    EXPECT_TRUE(isOneLine(end.standardError)) << end.standardError;
    std::ifstream stream(entry.path());
    std::string line;
    std::getline(stream, line);
    const std::string number = line.substr(2, line.find(':') - 2);
    EXPECT_THAT(end.standardError, HasSubstr(entry.path().filename().string() + ":" + number + ": "));
    EXPECT_EQ(end.standardOutput, "") << entry.path();
    ++files;
  }
  EXPECT_GE(files, 20);
}

/// The lines after "constructed by this server".
std::string constructed(const std::string& explanation) {
  const std::size_t at = explanation.find("constructed by this server");
  return at == std::string::npos ? "" : explanation.substr(explanation.find('\n', at) + 1);
}

TEST(ServerProgram, ExplainCountsExactlyWhatEachSceneNames) {
  const FinishedProcess moon = runServer({"--scene", "moon", "--explain"}),
                        smooth = runServer({"--scene", "smooth", "--explain"});
  EXPECT_EQ(moon.exitStatus, 0);
  EXPECT_EQ(smooth.exitStatus, 0);
  EXPECT_EQ(constructed(moon.standardOutput), "  field.lunar 1\n");
  EXPECT_EQ(constructed(smooth.standardOutput), "  field.sphere 1\n");
  EXPECT_THAT(moon.standardOutput, HasSubstr("sun: on; the scene has [effects.sun]"));
  EXPECT_THAT(smooth.standardOutput,
              HasSubstr("sun: off; the scene has no [effects.sun], so nothing of it is constructed"));
}

// With few file descriptors the server cannot take every connection; it must take new ones again as soon as it can.
TEST(ServerProgram, RunningOutOfFileDescriptorsDoesNotEndTheListener) {
  if (test::kAddressSanitizer)
    GTEST_SKIP()
        << "the undefined-behaviour sanitizer probes memory through a pipe, and without file descriptors takes "
           "all of it for bad";
  ServerProcess server({"--scene", "smooth"}, "ulimit -n 24; ");
  {
    std::vector<std::unique_ptr<HttpConnection>> connections;
    for (int i = 0; i < 40; ++i) {
      connections.push_back(std::make_unique<HttpConnection>(server.url()));
      ASSERT_TRUE(connections.back()->open());
    }
    while (server.openFiles() < 24) {
      ASSERT_TRUE(server.isRunning());
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_EQ(connections.front()->request("/healthz")->status, 200) << "those that have a place are served";
  }
  const auto answer = test::httpGet(server.url(), "/healthz");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  server.signal(SIGTERM);
  EXPECT_EQ(server.wait().exitStatus, 0);
}

}  // namespace
}  // namespace terrane

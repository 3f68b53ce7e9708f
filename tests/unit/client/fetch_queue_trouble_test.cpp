// What becomes of requests when the server closes, refuses, restarts, is silent or busy, or answers nonsense.

#include "client/net/fetch_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <memory>
#include <string>

#include "tests/unit/client/fake_server.h"
#include "tests/unit/client/fetch_answers.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace terrane::testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(FetchQueue, ReconnectsWhenTheServerClosedAnIdleConnection) {
  FakeServer server([](const std::string&) { return FakeReply{.body = "x", .closeAfter = true}; });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  for (int i = 0; i < 5; ++i) {
    queue->fetch(numbered(i), 0, answers.as(numbered(i)));
    ASSERT_TRUE(answers.waitFor(static_cast<std::size_t>(i) + 1));
    EXPECT_EQ(answers.response(numbered(i)).status, 200) << answers.response(numbered(i)).error.text();
  }
  EXPECT_TRUE(queue->status().reachable);
}

TEST(FetchQueue, RefusedConnectionIsReportedAndBacksOff) {
  Answers answers;
  auto queue = openQueue("http://127.0.0.1:" + std::to_string(testing::unusedPort()), [] {
    FetchOptions options;
    options.firstBackoff = options.longestBackoff = 1h;
    return options;
  }());
  for (int i = 0; i < 20; ++i) queue->fetch("/", i, answers.as(std::to_string(i)));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(answers.response("0").status, 0);
  EXPECT_EQ(answers.response("0").error.kind, ErrorKind::Io);
  ASSERT_TRUE(waitForStatus(*queue, [](const auto& s) { return s.running == 0; }));
  const auto status = queue->status();
  ASSERT_TRUE(answers.waitFor(status.requests));
  EXPECT_FALSE(status.reachable);
  EXPECT_FALSE(status.answered);
  EXPECT_GT(status.retryIn, 59min);
  EXPECT_LE(status.requests, 6u) << "the rest waits for the back-off: no flood";
  EXPECT_EQ(status.queued + answers.names().size(), 20u);
  EXPECT_THAT(status.lastError, HasSubstr("cannot connect"));
}

TEST(FetchQueue, ComesBackByItselfWhenTheServerStarts) {
  const int port = testing::unusedPort();
  Answers answers;
  auto queue = openQueue("http://127.0.0.1:" + std::to_string(port), quickRetry());
  queue->fetch("/dead", 0, answers.as("dead"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(answers.response("dead").status, 0);
  queue->fetch("/patient", 0, answers.as("patient"));
  ASSERT_TRUE(answers.waitFor(2)) << "one request at a time is tried while the server is dead";
  FakeServer server([](const std::string&) { return FakeReply{.body = "here"}; }, port);
  // Some of these may fall to tries that began before the server did.
  std::size_t asked = 2;
  do {
    queue->fetch("/again", 0, answers.as("again"));
    ASSERT_TRUE(answers.waitFor(++asked));
  } while (answers.response("again").status == 0);
  EXPECT_EQ(text(answers.response("again")), "here");
  EXPECT_TRUE(queue->status().reachable);
  EXPECT_EQ(queue->status().retryIn.count(), 0);
}

TEST(FetchQueue, SurvivesARestartOnTheSamePort) {
  auto first = std::make_unique<FakeServer>([](const std::string&) { return FakeReply{.body = "one"}; });
  const int port = first->port();
  Answers answers;
  auto queue = openQueue(first->url(), quickRetry());
  queue->fetch("/", 0, answers.as("one"));
  ASSERT_TRUE(answers.waitFor(1));
  first.reset();
  FakeServer second([](const std::string&) { return FakeReply{.body = "two"}; }, port);
  queue->fetch("/", 0, answers.as("two"));
  ASSERT_TRUE(answers.waitFor(2));
  EXPECT_EQ(text(answers.response("two")), "two") << "a stale connection is no failure";
}

TEST(FetchQueue, SilenceBecomesATimeout) {
  FakeServer server([](const std::string&) { return FakeReply{.hold = true}; });
  Answers answers;
  auto queue = openQueue(server.url(), impatient());
  queue->fetch("/", 0, answers.as("x"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(answers.response("x").status, 0);
  EXPECT_EQ(answers.response("x").error.kind, ErrorKind::Timeout);
  EXPECT_FALSE(queue->status().reachable);
  EXPECT_TRUE(server.waitForAbandoned(1));
}

TEST(FetchQueue, WhileNothingAnswersOneRequestAtATimeIsTried) {
  FakeServer server([](const std::string&) { return FakeReply{.hold = true}; });
  Answers answers;
  auto queue = openQueue(server.url(), impatient());
  for (int i = 0; i < 12; ++i) queue->fetch("/", i, answers.as(std::to_string(i)));
  ASSERT_TRUE(answers.waitFor(6));  // the first six were sent before anybody knew
  ASSERT_TRUE(server.waitForRequests(8));
  EXPECT_LE(queue->status().running, 1u);
  ASSERT_TRUE(answers.waitFor(12));
  EXPECT_EQ(server.targets().size(), 12u);
}

TEST(FetchQueue, ABusyServerIsLeftAloneAsLongAsItAsks) {
  FakeServer server([](const std::string& target) {
    return target == "/busy" ? FakeReply{.status = 503, .headers = "Retry-After: 3600\r\n"} : FakeReply{};
  });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  queue->fetch("/busy", 0, answers.as("busy"));
  queue->fetch("/waits", 1, answers.as("waits"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(answers.response("busy").status, 503);
  EXPECT_EQ(answers.response("busy").retryAfter, 60s) << "an hour is cut to a minute";
  const auto status = queue->status();
  EXPECT_TRUE(status.reachable);
  EXPECT_GT(status.retryIn, 50s);
  EXPECT_EQ(status.queued, 1u);
  EXPECT_THAT(server.targets(), ElementsAre("/busy"));
}

TEST(FetchQueue, NonsenseHalfAnswersAndGiantsAreErrorsOfTheirKind) {
  FakeServer server([](const std::string& target) {
    FakeReply reply;
    if (target == "/nonsense") reply.raw = "SSH-2.0-OpenSSH_9.2\r\n\r\n";
    if (target == "/half") reply.raw = "HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\nonly this";
    if (target == "/giant") reply.body = std::string(3000, 'x');
    if (target == "/lie") reply.raw = "HTTP/1.1 200 OK\r\nContent-Length: 99999999999999\r\n\r\n";
    if (target == "/closed") reply.raw = "\r";
    return reply;
  });
  FetchOptions options = quickRetry();
  options.maxBodyBytes = 2000;
  Answers answers;
  std::size_t asked = 0;
  auto queue = openQueue(server.url(), options);
  const std::map<std::string, ErrorKind> expected{{"/nonsense", ErrorKind::Malformed},
                                                  {"/half", ErrorKind::Io},
                                                  {"/giant", ErrorKind::TooLarge},
                                                  {"/lie", ErrorKind::TooLarge}};
  for (const auto& [target, kind] : expected) {
    queue->fetch(target, 0, answers.as(target));
    ASSERT_TRUE(answers.waitFor(++asked));
    EXPECT_EQ(answers.response(target).status, 0) << target;
    EXPECT_EQ(answers.response(target).error.kind, kind) << target << ": " << answers.response(target).error.text();
    EXPECT_TRUE(answers.response(target).body.empty()) << target;
  }
  queue->fetch("/fine", 0, answers.as("fine"));
  ASSERT_TRUE(answers.waitFor(++asked));
  EXPECT_EQ(answers.response("fine").status, 200);
}

}  // namespace
}  // namespace terrane

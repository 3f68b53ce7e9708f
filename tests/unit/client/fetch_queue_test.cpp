#include "client/net/fetch_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <map>
#include <mutex>

#include "tests/unit/client/fake_server.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using testing::FakeReply;
using testing::FakeServer;
using ::testing::HasSubstr;

/// Collects answers by name, in order of arrival; waits with a generous limit, never for a fixed time.
class Answers {
 public:
  FetchQueue::Callback as(std::string name) {
    return [this, name = std::move(name)](FetchResponse response) {
      const std::lock_guard lock(mutex_);
      names_.push_back(name);
      responses_[name] = std::move(response);
      changed_.notify_all();
    };
  }
  bool waitFor(std::size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 60s, [&] { return names_.size() >= count; });
  }
  std::vector<std::string> names() {
    const std::lock_guard lock(mutex_);
    return names_;
  }
  FetchResponse response(const std::string& name) {
    const std::lock_guard lock(mutex_);
    return responses_[name];
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> names_;
  std::map<std::string, FetchResponse> responses_;
};

std::unique_ptr<FetchQueue> openQueue(const std::string& url, FetchOptions options = {}) {
  options.serverUrl = url;
  auto queue = FetchQueue::open(options);
  EXPECT_TRUE(queue) << queue.error().text();
  return std::move(*queue);
}

FetchOptions oneConnection() {
  FetchOptions options;
  options.connections = 1;
  return options;
}

FetchOptions quickRetry() {
  FetchOptions options;
  options.firstBackoff = 10ms;
  options.longestBackoff = 40ms;
  return options;
}

/// Only where a time-out is what is tested: a busy machine may well be silent for a tenth of a second.
FetchOptions impatient() {
  FetchOptions options = quickRetry();
  options.timeout = 100ms;
  return options;
}

std::string numbered(int i) { return std::string("/").append(std::to_string(i)); }

std::string text(const FetchResponse& response) { return {response.body.begin(), response.body.end()}; }

/// Polls the queue's own status; for states that no callback tells.
bool waitForStatus(const FetchQueue& queue, const std::function<bool(const FetchQueue::Status&)>& reached) {
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < deadline) {
    if (reached(queue.status())) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

TEST(FetchQueue, WrongUrlNamesTheFlag) {
  FetchOptions options;
  options.serverUrl = "localhost";
  const auto queue = FetchQueue::open(options);
  ASSERT_FALSE(queue);
  EXPECT_EQ(queue.error().field, "--server");
}

TEST(FetchQueue, ManyRequestsShareOneKeptConnection) {
  FakeServer server([](const std::string& target) { return FakeReply{.body = "body of " + target}; });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  for (int i = 0; i < 50; ++i) queue->fetch(numbered(i), i, answers.as(std::to_string(i)));
  ASSERT_TRUE(answers.waitFor(50));
  EXPECT_EQ(server.connections(), 1);
  EXPECT_EQ(answers.response("17").status, 200);
  EXPECT_EQ(text(answers.response("17")), "body of /17");
  const auto status = queue->status();
  EXPECT_EQ(status.requests, 50u);
  EXPECT_EQ(status.connects, 1u);
  EXPECT_GT(status.bytesReceived, 50u * 8);
  EXPECT_TRUE(status.answered);
}

TEST(FetchQueue, NeverOpensMoreConnectionsThanAllowed) {
  FakeServer server([](const std::string&) { return FakeReply{.hold = true}; });
  FetchOptions options;
  options.connections = 3;
  Answers answers;
  auto queue = openQueue(server.url(), options);
  for (int i = 0; i < 20; ++i) queue->fetch("/", i, answers.as(std::to_string(i)));
  ASSERT_TRUE(server.waitForHolding(3));
  EXPECT_EQ(queue->status().running, 3u);
  EXPECT_EQ(queue->status().queued, 17u);
  server.releaseAll();
  ASSERT_TRUE(answers.waitFor(20));
  EXPECT_EQ(server.connections(), 3);
}

TEST(FetchQueue, LowerPriorityValuesGoFirstEvenIfTheyCameLast) {
  FakeServer server([](const std::string& target) { return FakeReply{.hold = target == "/first"}; });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  queue->fetch("/first", 99, answers.as("first"));
  ASSERT_TRUE(server.waitForHolding(1));
  queue->fetch("/c", 3, answers.as("c"));
  queue->fetch("/b", 2, answers.as("b"));
  const auto changed = queue->fetch("/a", 9, answers.as("a"));
  queue->fetch("/d", 4, answers.as("d"));
  queue->setPriority(changed, 1);
  server.releaseAll();
  ASSERT_TRUE(answers.waitFor(5));
  EXPECT_THAT(server.targets(), ElementsAre("/first", "/a", "/b", "/c", "/d"));
}

TEST(FetchQueue, WhatWasCancelledInTheQueueIsNeverSent) {
  FakeServer server([](const std::string& target) { return FakeReply{.hold = target == "/first"}; });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  queue->fetch("/first", 0, answers.as("first"));
  ASSERT_TRUE(server.waitForHolding(1));
  const auto id = queue->fetch("/cancelled", 1, answers.as("cancelled"));
  queue->fetch("/last", 2, answers.as("last"));
  EXPECT_TRUE(queue->cancel(id));
  EXPECT_FALSE(queue->cancel(id)) << "a second time there is nothing left to cancel";
  server.releaseAll();
  ASSERT_TRUE(answers.waitFor(2));
  EXPECT_THAT(server.targets(), ElementsAre("/first", "/last"));
  EXPECT_THAT(answers.names(), ElementsAre("first", "last"));
}

TEST(FetchQueue, CancellingARunningRequestClosesItsConnectionAndNoOther) {
  FakeServer server([](const std::string&) { return FakeReply{.body = "x", .hold = true}; });
  FetchOptions options;
  options.connections = 2;
  Answers answers;
  auto queue = openQueue(server.url(), options);
  const auto id = queue->fetch("/cancelled", 0, answers.as("cancelled"));
  ASSERT_TRUE(server.waitForHolding(1));
  queue->fetch("/kept", 1, answers.as("kept"));
  ASSERT_TRUE(server.waitForHolding(2));
  EXPECT_TRUE(queue->cancel(id));
  ASSERT_TRUE(server.waitForAbandoned(1));
  queue->fetch("/after", 2, answers.as("after"));
  ASSERT_TRUE(server.waitForRequests(3));
  server.releaseAll();
  ASSERT_TRUE(answers.waitFor(2));
  EXPECT_EQ(server.abandoned(), 1);
  EXPECT_EQ(server.connections(), 3);
  EXPECT_EQ(answers.response("kept").status, 200);
  EXPECT_EQ(answers.response("after").status, 200);
  EXPECT_TRUE(queue->status().reachable);
}

TEST(FetchQueue, AnAnswerThatIsNearlyThereIsReadToItsEndWhenCancelled) {
  // Half of a small body has come: to throw the connection away would cost more than the other half.
  FakeServer server([](const std::string& target) {
    return FakeReply{.body = std::string(1000, 'x'), .holdHalfway = target == "/small"};
  });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  const auto id = queue->fetch("/small", 0, answers.as("small"));
  ASSERT_TRUE(waitForStatus(*queue, [](const auto& s) { return s.bytesReceived >= 500; }));
  EXPECT_TRUE(queue->cancel(id));
  queue->fetch("/next", 1, answers.as("next"));
  server.releaseAll();
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_THAT(answers.names(), ElementsAre("next"));
  EXPECT_EQ(server.connections(), 1);
  EXPECT_EQ(server.abandoned(), 0);
}

TEST(FetchQueue, ALargeAnswerIsCutOffWhenCancelled) {
  FakeServer server([](const std::string& target) {
    return FakeReply{.body = std::string(1 << 20, 'x'), .holdHalfway = target == "/large"};
  });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  const auto id = queue->fetch("/large", 0, answers.as("large"));
  ASSERT_TRUE(waitForStatus(*queue, [](const auto& s) { return s.bytesReceived >= 1000; }));
  EXPECT_TRUE(queue->cancel(id));
  ASSERT_TRUE(server.waitForAbandoned(1));
  queue->fetch("/next", 1, answers.as("next"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(server.connections(), 2);
}

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

TEST(FetchQueue, ChunkedAnswersAreRead) {
  FakeServer server([](const std::string&) {
    return FakeReply{.raw = "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n2\r\nde\r\n0\r\n\r\n"};
  });
  Answers answers;
  auto queue = openQueue(server.url());
  queue->fetch("/", 0, answers.as("x"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(text(answers.response("x")), "abcde");
}

TEST(FetchQueue, DelayedRequestsWaitTheirTime) {
  FakeServer server([](const std::string&) { return FakeReply{}; });
  Answers answers;
  auto queue = openQueue(server.url(), oneConnection());
  queue->fetch("/late", 0, answers.as("late"), 1h);
  const auto soon = std::chrono::steady_clock::now();
  queue->fetch("/soon", 1, answers.as("soon"), 30ms);
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_GE(std::chrono::steady_clock::now() - soon, 30ms);
  EXPECT_THAT(answers.names(), ElementsAre("soon"));
  EXPECT_EQ(queue->status().queued, 1u);
}

TEST(FetchQueue, DestructionInTheMiddleOfEverythingCallsNothingBack) {
  FakeServer server([](const std::string& target) {
    return FakeReply{.body = std::string(5000, 'x'), .hold = target.back() % 2 == 0};
  });
  for (int round = 0; round < 20; ++round) {
    std::atomic<bool> destroyed{false};
    std::atomic<int> late{0};
    auto queue = openQueue(server.url());
    for (int i = 0; i < 30; ++i) {
      queue->fetch(numbered(i), i, [&](FetchResponse) { late += destroyed ? 1 : 0; });
    }
    if (round % 2) {
      ASSERT_TRUE(server.waitForRequests(static_cast<std::size_t>(round)));
    }
    queue.reset();
    destroyed = true;
    EXPECT_EQ(late, 0);
  }
}

TEST(FetchQueue, HammeredFromSeveralThreadsEveryRequestEndsOnce) {
  FakeServer server([](const std::string&) { return FakeReply{.body = "x"}; });
  constexpr int kThreads = 4, kEach = 100;
  std::atomic<int> answered{0}, cancelled{0};
  auto queue = openQueue(server.url());
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kEach; ++i) {
        const auto id = queue->fetch("/x", i, [&](FetchResponse) { ++answered; });
        if ((i + t) % 3 == 0) queue->setPriority(id, -i);
        if ((i + t) % 2 == 0 && queue->cancel(id)) ++cancelled;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (answered + cancelled < kThreads * kEach && std::chrono::steady_clock::now() < deadline)
    std::this_thread::yield();
  EXPECT_EQ(answered + cancelled, kThreads * kEach);
  EXPECT_TRUE(waitForStatus(*queue, [](const auto& s) { return s.running == 0 && s.queued == 0; }));
  EXPECT_EQ(answered + cancelled, kThreads * kEach);
}

}  // namespace
}  // namespace terrane

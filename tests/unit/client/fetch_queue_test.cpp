#include "client/net/fetch_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "tests/unit/client/fake_server.h"
#include "tests/unit/client/fetch_answers.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace terrane::testing;
using ::testing::ElementsAre;

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

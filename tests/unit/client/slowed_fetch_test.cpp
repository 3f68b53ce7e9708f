// The fetch queue behind a simulated link: slow, in order, and never taken for dead.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "client/net/fetch_queue.h"
#include "tests/unit/client/fake_server.h"
#include "tests/unit/client/fetch_answers.h"

namespace terrane {
namespace {

using namespace std::chrono_literals;
using namespace terrane::testing;
using ::testing::ElementsAre;
using Clock = std::chrono::steady_clock;

FetchOptions slowed(FetchOptions options, const NetworkConditions& network) {
  options.network = network;
  return options;
}

TEST(SlowedFetch, NoAnswerComesBeforeItsLatencyAndItsShareOfThePipe) {
  constexpr int kAnswers = 12;
  constexpr std::size_t kBytes = 5'000;
  constexpr std::uint64_t kRate = 1'000'000;
  FakeServer server([](const std::string&) { return FakeReply{.body = std::string(kBytes, 'x')}; });
  Answers answers;
  const auto start = Clock::now();
  auto queue = openQueue(server.url(), slowed({}, {100ms, kRate}));
  for (int i = 0; i < kAnswers; ++i) queue->fetch(numbered(i), i, answers.as(std::to_string(i)));
  ASSERT_TRUE(answers.waitFor(kAnswers));
  // Six connections: two rounds of latency, and all bytes one after another.
  EXPECT_GE(Clock::now() - start, 200ms);
  EXPECT_GE(Clock::now() - start, 100ms + kAnswers * kBytes * 1s / kRate);
  for (int i = 0; i < kAnswers; ++i) {
    EXPECT_EQ(answers.response(std::to_string(i)).status, 200);
    EXPECT_EQ(answers.response(std::to_string(i)).body.size(), kBytes);
  }
  EXPECT_EQ(queue->status().connects, 6u) << "connections are kept";
}

TEST(SlowedFetch, TimeLimitsDoNotCountWhatIsSimulated) {
  // The whole request may take four times the limit; the simulated link takes longer than that.
  FakeServer server([](const std::string&) { return FakeReply{.body = "x"}; });
  FetchOptions options = quickRetry();
  options.timeout = 500ms;
  Answers answers;
  const auto start = Clock::now();
  auto queue = openQueue(server.url(), slowed(options, {2100ms, 0}));
  queue->fetch("/", 0, answers.as("x"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_GE(Clock::now() - start, 2100ms);
  EXPECT_EQ(answers.response("x").status, 200) << answers.response("x").error.text();
  EXPECT_TRUE(queue->status().reachable);
  EXPECT_EQ(queue->status().requests, 1u) << "not tried again";
}

TEST(SlowedFetch, AServerThatIsSilentIsStillFoundOut) {
  FakeServer server([](const std::string&) { return FakeReply{.hold = true}; });
  FetchOptions options = impatient();
  options.firstBackoff = options.longestBackoff = 1h;
  Answers answers;
  auto queue = openQueue(server.url(), slowed(options, {50ms, 10'000}));
  queue->fetch("/", 0, answers.as("x"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_EQ(answers.response("x").error.kind, ErrorKind::Timeout);
  EXPECT_FALSE(queue->status().reachable);
}

TEST(SlowedFetch, ACancelledAnswerIsReadAwayAndTheConnectionServesTheNext) {
  FakeServer server([](const std::string&) { return FakeReply{.body = std::string(2'000, 'x')}; });
  Answers answers;
  auto queue = openQueue(server.url(), slowed(oneConnection(), {100ms, 0}));
  const auto start = Clock::now();
  const auto id = queue->fetch("/cancelled", 0, answers.as("cancelled"));
  ASSERT_TRUE(waitForStatus(*queue, [](const auto& s) { return s.bytesReceived > 2'000; })) << "held by the link now";
  EXPECT_TRUE(queue->cancel(id));
  queue->fetch("/next", 1, answers.as("next"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_THAT(answers.names(), ElementsAre("next"));
  EXPECT_GE(Clock::now() - start, 200ms) << "the connection was not free sooner";
  EXPECT_EQ(server.connections(), 1);
}

TEST(SlowedFetch, WhatACancelledRequestHadBroughtHoldsUpTheOthers) {
  FakeServer server([](const std::string& target) {
    return FakeReply{.body = std::string(target == "/large" ? 1 << 20 : 10, 'x'), .holdHalfway = target == "/large"};
  });
  Answers answers;
  auto queue = openQueue(server.url(), slowed(oneConnection(), {0ms, 2'000'000}));
  const auto id = queue->fetch("/large", 0, answers.as("large"));
  ASSERT_TRUE(waitForStatus(*queue, [](const auto& s) { return s.bytesReceived >= 1 << 19; }));
  const auto start = Clock::now();
  EXPECT_TRUE(queue->cancel(id));
  ASSERT_TRUE(server.waitForAbandoned(1));
  queue->fetch("/small", 0, answers.as("small"));
  ASSERT_TRUE(answers.waitFor(1));
  EXPECT_GE(Clock::now() - start, std::chrono::milliseconds((1000 << 19) / 2'000'000));
}

TEST(SlowedFetch, DestructionWhileAnswersAreHeldCallsNothingBack) {
  FakeServer server([](const std::string&) { return FakeReply{.body = "x"}; });
  Answers answers;
  auto queue = openQueue(server.url(), slowed({}, {10s, 1'000}));
  for (int i = 0; i < 20; ++i) queue->fetch(numbered(i), i, answers.as(numbered(i)));
  ASSERT_TRUE(server.waitForRequests(6));
  queue.reset();
  EXPECT_TRUE(answers.names().empty());
}

}  // namespace
}  // namespace terrane

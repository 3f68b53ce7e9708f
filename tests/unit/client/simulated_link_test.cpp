#include "client/net/simulated_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <random>

namespace terrane {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Time = SimulatedLink::Time;
using Id = SimulatedLink::Id;

const Time kStart{1000s};

/// Steps from event to event, as a timer would; when each answer was delivered.
std::map<Id, Time> deliverAll(SimulatedLink& link) {
  std::map<Id, Time> delivered;
  while (const auto next = link.nextDelivery()) {
    EXPECT_THAT(link.deliver(*next - 1ns), IsEmpty()) << "not a nanosecond sooner";
    for (const Id id : link.deliver(*next)) delivered[id] = *next;
  }
  return delivered;
}

TEST(SimulatedLink, EqualAnswersComeOneAfterAnotherAtTheRateOfThePipe) {
  SimulatedLink link({200ms, 1'000'000});
  for (Id id = 1; id <= 50; ++id) link.answered(id, kStart, kStart + 3ms, 20'000);
  const auto delivered = deliverAll(link);
  ASSERT_EQ(delivered.size(), 50u);
  for (const auto& [id, time] : delivered) EXPECT_EQ(time, kStart + 200ms + id * 20ms) << "answer " << id;
}

TEST(SimulatedLink, RequestsSideBySideOverlapTheirLatenciesAndShareTheBandwidth) {
  // Both ask at once: one latency, then twice the bytes. One after the other: two latencies.
  SimulatedLink sideBySide({200ms, 1'000'000});
  sideBySide.answered(1, kStart, kStart, 100'000);
  sideBySide.answered(2, kStart, kStart, 100'000);
  EXPECT_EQ(deliverAll(sideBySide).at(2), kStart + 200ms + 2 * 100ms);
  SimulatedLink inTurn({200ms, 1'000'000});
  inTurn.answered(1, kStart, kStart, 100'000);
  const Time first = deliverAll(inTurn).at(1);
  inTurn.answered(2, first, first, 100'000);
  EXPECT_EQ(deliverAll(inTurn).at(2), kStart + 2 * (200ms + 100ms));
}

TEST(SimulatedLink, WhatReachesThePipeFirstPassesFirstWhicheverCameInFirst) {
  SimulatedLink link({200ms, 1'000'000});
  link.answered(2, kStart + 50ms, kStart + 60ms, 1'000);  // a quick answer to a late request
  link.answered(1, kStart, kStart + 150ms, 1'000);        // a slow one to an early request
  const auto delivered = deliverAll(link);
  EXPECT_EQ(delivered.at(1), kStart + 201ms);
  EXPECT_EQ(delivered.at(2), kStart + 251ms);
}

TEST(SimulatedLink, ASlowServerIsNotMadeFaster) {
  SimulatedLink link({200ms, 0});
  link.answered(1, kStart, kStart + 900ms, 1'000'000);
  EXPECT_EQ(link.nextDelivery(), kStart + 900ms);
  SimulatedLink pipe({0ms, 1'000});
  pipe.answered(1, kStart, kStart + 900ms, 500);
  EXPECT_EQ(pipe.nextDelivery(), kStart + 900ms + 500ms);
}

TEST(SimulatedLink, WhatNobodyWaitsForHasUsedThePipeAllTheSame) {
  SimulatedLink link({200ms, 1'000'000});
  link.answered(SimulatedLink::kNobody, kStart, kStart, 300'000);
  link.answered(1, kStart, kStart, 100'000);
  const auto delivered = deliverAll(link);
  EXPECT_EQ(delivered.size(), 1u);
  EXPECT_EQ(delivered.at(1), kStart + 200ms + 400ms);
}

TEST(SimulatedLink, AnIdlePipeSavesNothingUp) {
  SimulatedLink link({0ms, 1'000'000});
  link.answered(1, kStart, kStart, 1'000);
  EXPECT_EQ(deliverAll(link).at(1), kStart + 1ms);
  link.answered(2, kStart + 10s, kStart + 10s, 1'000'000);
  EXPECT_EQ(deliverAll(link).at(2), kStart + 11s);
}

TEST(SimulatedLink, TheLargestAnswerAndTheFastestPipeStayInRange) {
  SimulatedLink slow({10s, 1'000});
  slow.answered(1, kStart, kStart, std::size_t{1} << 62);
  EXPECT_GT(*slow.nextDelivery(), kStart + std::chrono::hours(24 * 10));
  SimulatedLink fast({0ms, SimulatedLink::kMostBytesPerSecond});
  fast.answered(1, kStart, kStart, 1);
  EXPECT_EQ(fast.nextDelivery(), kStart + 1ns) << "rounded up: never early";
}

TEST(SimulatedLink, ManyRandomAnswersKeepLatencyRateAndOrder) {
  constexpr unsigned kSeed = 20260714;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  constexpr auto kLatency = 80ms;
  constexpr std::uint64_t kRate = 500'000;
  SimulatedLink link({kLatency, kRate});
  struct Answer {
    Time made, came;
    std::size_t bytes = 0;
  };
  std::map<Id, Answer> answers;
  std::vector<std::pair<Id, Time>> delivered;
  const auto deliverUntil = [&](Time end) {
    while (link.nextDelivery() && *link.nextDelivery() <= end) {
      const Time next = *link.nextDelivery();
      for (const Id id : link.deliver(next)) delivered.emplace_back(id, next);
    }
  };
  Time now = kStart;
  for (Id id = 1; id <= 2000; ++id) {
    now += std::chrono::microseconds(random() % 60'000);
    deliverUntil(now);
    answers[id] = {now - std::chrono::microseconds(random() % 200'000), now, random() % 30'000};
    link.answered(id, answers[id].made, now, answers[id].bytes);
  }
  deliverUntil(Time::max());
  ASSERT_EQ(delivered.size(), answers.size());
  // By hand: in order of reaching the pipe, each begins when it is there and the one before is through.
  std::vector<std::pair<Time, Id>> expected;
  for (const auto& [id, answer] : answers) expected.emplace_back(std::max(answer.came, answer.made + kLatency), id);
  std::sort(expected.begin(), expected.end());
  Time free = kStart;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto& [reaches, id] = expected[i];
    const std::uint64_t bytes = answers[id].bytes;
    free = std::max(reaches, free) + std::chrono::nanoseconds((bytes * 1'000'000'000 + kRate - 1) / kRate);
    EXPECT_EQ(delivered[i].first, id);
    EXPECT_EQ(delivered[i].second, free);
    EXPECT_GE(delivered[i].second, answers[id].made + kLatency);
  }
}

}  // namespace
}  // namespace terrane

#pragma once
// How a bad network would have delivered what a good one brought: a model without threads, timers or sockets. An answer
// reaches the client's end of the line no earlier than latency after its request was made; from there all answers, of
// whatever connection, pass one pipe of so many bytes a second, one after another in the order in which they reached
// it. So requests that run side by side overlap their latencies and share the bandwidth. What is on its way cannot be
// called back: a request that is given up has used the pipe for what the server had sent.
//
// Times are passed in and must not go backwards. Not thread-safe.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

namespace terrane {

struct NetworkConditions {
  std::chrono::milliseconds latency{0};  ///< from making a request to the first byte of its answer, at least
  std::uint64_t bytesPerSecond = 0;      ///< of all answers together, headers included; 0: as many as come
  bool simulated() const noexcept { return latency.count() > 0 || bytesPerSecond > 0; }
};

class SimulatedLink {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Names an answer; kNobody is one that nobody waits for any more.
  using Id = std::uint64_t;
  static constexpr Id kNobody = 0;
  /// Larger answers take no longer than one of this size, so that times fit into 64 bits of nanoseconds.
  static constexpr std::uint64_t kMostBytes = 1u << 30;
  static constexpr std::uint64_t kMostBytesPerSecond = 1'000'000'000'000;

  /// Precondition: bytesPerSecond is at most kMostBytesPerSecond.
  explicit SimulatedLink(const NetworkConditions& conditions) : conditions_(conditions) {}

  /// The real answer to a request made then, or what came of it before it was given up, is here at `now`.
  void answered(Id id, Time made, Time now, std::size_t bytes);
  /// When the next answer is through the pipe; empty when nothing is on its way.
  std::optional<Time> nextDelivery() const;
  /// Those that are through the pipe at `now`, in order; kNobody's are left out.
  std::vector<Id> deliver(Time now);

 private:
  struct Answer {
    Time reachesPipe;
    std::uint64_t order = 0;  ///< of arrival, among those that reach the pipe at the same time
    Id id = kNobody;
    std::size_t bytes = 0;
    bool operator<(const Answer& other) const {
      return reachesPipe != other.reachesPipe ? reachesPipe < other.reachesPipe : order < other.order;
    }
  };
  Time throughPipe(const Answer& answer) const;

  NetworkConditions conditions_;
  /// An answer that comes in later reaches the pipe no earlier than now, and so never before one that is in it.
  std::set<Answer> onTheirWay_;
  Time pipeFree_ = Time::min();
  std::uint64_t nextOrder_ = 0;
};

}  // namespace terrane

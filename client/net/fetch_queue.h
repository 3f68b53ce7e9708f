#pragma once
// A queue of GET requests over a few kept HTTP/1.1 connections: highest priority first, cancellation of what is no
// longer wanted, time limits, back-off while the server is dead. All members are thread-safe; results come back through
// the callback, called from the queue's own thread.
//
// While the server does not answer (nothing came back since a connection or a time limit failed), requests stay queued
// and one at a time is tried, each after twice the pause of the one before; the first answer of any kind ends that. A
// 503 with Retry-After holds all further requests for that long: the server has said that its queue is full.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/net/simulated_link.h"
#include "common/result.h"

namespace terrane {

struct FetchOptions {
  std::string serverUrl;
  int connections = 6;
  /// Without a byte from the server; a whole request may take four times as long.
  std::chrono::milliseconds timeout{30'000};
  std::chrono::milliseconds firstBackoff{250}, longestBackoff{15'000};
  std::size_t maxBodyBytes = 16u << 20;
  /// A worse network than the real one, to see how that feels. Time limits do not count what it adds.
  NetworkConditions network = {};
};

struct FetchResponse {
  int status = 0;  ///< HTTP status; 0 if there was no answer (then error says why: Io, Timeout, Malformed, TooLarge)
  std::vector<std::uint8_t> body;
  Error error;
  std::chrono::milliseconds retryAfter{0};  ///< what the server asked for, in seconds on the wire, at most a minute
};

class FetchQueue {
 public:
  using Callback = std::function<void(FetchResponse)>;
  using Id = std::uint64_t;

  /// Errors: InvalidArgument naming "--server".
  static Result<std::unique_ptr<FetchQueue>> open(const FetchOptions& options);
  /// Cancels everything; no callback runs after it. Not to be called from a callback.
  ~FetchQueue();
  FetchQueue(const FetchQueue&) = delete;
  FetchQueue& operator=(const FetchQueue&) = delete;

  /// Lower priority values go first. The callback runs exactly once unless cancel(id) returned true. It must not throw.
  Id fetch(std::string target, double priority, Callback callback, std::chrono::milliseconds delay = {});
  void setPriority(Id id, double priority);
  /// True if the callback will not be called any more. A running request's connection is closed, so that the server can
  /// drop the work, unless the rest of the answer is so short that a new connection would cost more.
  bool cancel(Id id);

  struct Status {
    std::size_t queued = 0, running = 0;
    std::uint64_t requests = 0, bytesReceived = 0;  ///< sent; read from sockets, headers included
    std::uint64_t connects = 0;                     ///< connections opened or tried
    bool answered = false;                          ///< anything at all has come from the server
    bool reachable = true;                 ///< false after a failed connect or a time-out, until something answers
    std::chrono::milliseconds retryIn{0};  ///< while not reachable, or asked to wait by a 503
    std::chrono::milliseconds longestRunning{0};  ///< age of the oldest request that waits for its answer
    std::string lastError;                        ///< of the last failure; empty after an answer
  };
  Status status() const;
  /// "http://host:port".
  const std::string& origin() const;

 private:
  struct State;
  explicit FetchQueue(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane

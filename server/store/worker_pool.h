#pragma once
// A bounded pool of worker threads with a bounded queue, highest priority first, first come first served within one. A
// queued job can be withdrawn, so that what nobody wants any more holds no place. Thread-safe.

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace terrane {

class WorkerPool {
 public:
  /// Names a queued job; ordered as the queue is.
  struct JobId {
    int negatedPriority = 0;
    std::uint64_t sequence = 0;
    auto operator<=>(const JobId&) const = default;  // NOLINT(modernize-use-nullptr): clang 14
  };

  /// At least one thread.
  WorkerPool(int threads, std::size_t maxQueued);
  /// As stop().
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Empty when the queue is full or the pool is stopping; the job is then destroyed in the caller's thread. A job must
  /// not throw; what it throws is logged and swallowed.
  std::optional<JobId> post(int priority, std::function<void()> job);
  /// True if the job was still queued: it is destroyed and will not run.
  bool withdraw(const JobId& id);
  /// Finishes what runs, drops what is queued, and waits for the threads. Not from a job.
  void stop();
  std::size_t queued() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace terrane

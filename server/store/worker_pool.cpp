#include "server/store/worker_pool.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace terrane {

struct WorkerPool::State {
  mutable std::mutex mutex;
  std::condition_variable wake;
  std::map<JobId, std::function<void()>> queue;
  std::uint64_t nextSequence = 0;
  std::size_t maxQueued = 0;
  bool stopping = false;
  std::vector<std::thread> threads;
  std::once_flag joined;

  void work();
};

void WorkerPool::State::work() {
  for (;;) {
    std::function<void()> job;
    {
      std::unique_lock lock(mutex);
      wake.wait(lock, [this] { return stopping || !queue.empty(); });
      if (stopping) return;
      job = std::move(queue.extract(queue.begin()).mapped());
    }
    try {
      job();
    } catch (const std::exception& error) {
      spdlog::error("a job failed: {}", error.what());
    } catch (...) {
      spdlog::error("a job failed with an unknown exception");
    }
  }
}

WorkerPool::WorkerPool(int threads, std::size_t maxQueued) : state_(std::make_unique<State>()) {
  state_->maxQueued = maxQueued;
  for (int i = 0; i < std::max(1, threads); ++i)
    state_->threads.emplace_back([state = state_.get()] { state->work(); });
}

WorkerPool::~WorkerPool() { stop(); }

std::optional<WorkerPool::JobId> WorkerPool::post(int priority, std::function<void()> job) {
  JobId id{-priority, 0};
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->stopping || state_->queue.size() >= state_->maxQueued) return std::nullopt;
    id.sequence = state_->nextSequence++;
    state_->queue.emplace(id, std::move(job));
  }
  state_->wake.notify_one();
  return id;
}

bool WorkerPool::withdraw(const JobId& id) {
  std::map<JobId, std::function<void()>>::node_type
      dropped;  // destroyed outside the lock: a job's end may call back into here
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->queue.find(id);
  if (found == state_->queue.end()) return false;
  dropped = state_->queue.extract(found);
  return true;
}

void WorkerPool::stop() {
  std::map<JobId, std::function<void()>> dropped;
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
    dropped.swap(state_->queue);
  }
  state_->wake.notify_all();
  dropped.clear();
  std::call_once(state_->joined, [this] {
    for (std::thread& thread : state_->threads) thread.join();
  });
}

std::size_t WorkerPool::queued() const {
  const std::lock_guard lock(state_->mutex);
  return state_->queue.size();
}

}  // namespace terrane

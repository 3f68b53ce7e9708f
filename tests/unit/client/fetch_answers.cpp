#include "tests/unit/client/fetch_answers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace terrane::testing {

using namespace std::chrono_literals;

FetchQueue::Callback Answers::as(std::string name) {
  return [this, name = std::move(name)](FetchResponse response) {
    const std::lock_guard lock(mutex_);
    names_.push_back(name);
    responses_[name] = std::move(response);
    changed_.notify_all();
  };
}

bool Answers::waitFor(std::size_t count) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, 60s, [&] { return names_.size() >= count; });
}

std::vector<std::string> Answers::names() {
  const std::lock_guard lock(mutex_);
  return names_;
}

FetchResponse Answers::response(const std::string& name) {
  const std::lock_guard lock(mutex_);
  return responses_[name];
}

std::unique_ptr<FetchQueue> openQueue(const std::string& url, FetchOptions options) {
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

FetchOptions impatient() {
  FetchOptions options = quickRetry();
  options.timeout = 100ms;
  return options;
}

bool waitForStatus(const FetchQueue& queue, const std::function<bool(const FetchQueue::Status&)>& reached) {
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < deadline) {
    if (reached(queue.status())) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

}  // namespace terrane::testing

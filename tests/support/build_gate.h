#pragma once
// A gate before the builds of a test, so that it decides how long they take. Any thread.

#include <condition_variable>
#include <mutex>

namespace terrane::testing_support {

class BuildGate {
 public:
  /// For a build: counts it, and waits as long as the gate is held.
  void pass() {
    std::unique_lock lock(mutex_);
    ++begun_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !held_; });
  }
  void hold() {
    const std::lock_guard lock(mutex_);
    held_ = true;
  }
  void release() {
    const std::lock_guard lock(mutex_);
    held_ = false;
    changed_.notify_all();
  }
  /// Until so many builds have come here, over all.
  void waitForBuilds(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return begun_ >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool held_ = false;
  int begun_ = 0;
};

}  // namespace terrane::testing_support

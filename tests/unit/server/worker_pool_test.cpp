#include "server/store/worker_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace terrane {
namespace {

/// Occupies the only worker of a pool until it is opened. The worker shares what it waits on, for it may still be
/// looking at it when a test ends.
class Gate {
 public:
  explicit Gate(WorkerPool& pool) {
    EXPECT_TRUE(pool.post(1000, [state = state_] {
      state->entered.set_value();
      state->opened.get_future().wait();
    }));
    state_->entered.get_future().wait();
  }
  void open() { state_->opened.set_value(); }

 private:
  struct State {
    std::promise<void> entered, opened;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

TEST(WorkerPool, RunsTheHighestPriorityFirstAndEqualOnesInTheirOrder) {
  std::mutex mutex;
  std::vector<int> order;
  std::promise<void> done;
  WorkerPool pool(1, 100);
  Gate gate(pool);
  const auto job = [&](int name) {
    return [&, name] {
      const std::lock_guard lock(mutex);
      order.push_back(name);
      if (order.size() == 5) done.set_value();
    };
  };
  pool.post(-3, job(31));
  pool.post(0, job(1));
  pool.post(-3, job(32));
  pool.post(5, job(0));
  pool.post(-2, job(2));
  gate.open();
  done.get_future().wait();
  EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 31, 32));
}

TEST(WorkerPool, RefusesAJobWhenTheQueueIsFull) {
  WorkerPool pool(1, 2);
  Gate gate(pool);
  EXPECT_TRUE(pool.post(0, [] {}));
  EXPECT_TRUE(pool.post(0, [] {}));
  EXPECT_FALSE(pool.post(9, [] {}));
  EXPECT_EQ(pool.queued(), 2u);
  gate.open();
}

TEST(WorkerPool, AWithdrawnJobDoesNotRunAndItsPlaceIsFree) {
  bool withdrawnRan = false;
  std::promise<void> done;
  WorkerPool pool(1, 1);
  Gate gate(pool);
  const auto id = pool.post(0, [&] { withdrawnRan = true; });
  ASSERT_TRUE(id);
  EXPECT_TRUE(pool.withdraw(*id));
  EXPECT_FALSE(pool.withdraw(*id));
  EXPECT_TRUE(pool.post(0, [&] { done.set_value(); }));
  gate.open();
  done.get_future().wait();
  EXPECT_FALSE(withdrawnRan);
}

TEST(WorkerPool, StopDestroysWhatIsQueuedAndRefusesNewJobs) {
  WorkerPool pool(1, 10);
  Gate gate(pool);
  bool ran = false;
  auto resource = std::make_shared<int>(1);
  pool.post(0, [&ran, resource] { ran = true; });
  EXPECT_EQ(resource.use_count(), 2);
  // The queue is emptied before stop() waits for the running job, so the job that holds the gate may be let go by its
  // end.
  std::thread stopper([&] { pool.stop(); });
  while (pool.queued() > 0) std::this_thread::yield();
  gate.open();
  stopper.join();
  EXPECT_FALSE(ran);
  EXPECT_EQ(resource.use_count(), 1);
  EXPECT_FALSE(pool.post(0, [] {}));
  pool.stop();  // a second time does nothing
}

TEST(WorkerPool, AJobThatThrowsDoesNotEndItsThread) {
  std::promise<void> done;
  WorkerPool pool(1, 10);
  pool.post(0, [] { throw std::runtime_error("thrown by a test"); });
  pool.post(0, [] { throw 7; });
  pool.post(0, [&] { done.set_value(); });
  done.get_future().wait();
}

TEST(WorkerPool, EveryJobOfManyThreadsRunsOnce) {
  std::atomic<int> ran{0};
  constexpr int kThreads = 4, kJobs = 500;
  {
    WorkerPool pool(3, kThreads * kJobs);
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < kJobs; ++i) ASSERT_TRUE(pool.post(i % 7, [&] { ++ran; }));
      });
    for (std::thread& thread : threads) thread.join();
    while (pool.queued() > 0) std::this_thread::yield();
  }  // the destructor waits for what runs
  EXPECT_EQ(ran, kThreads * kJobs);
}

}  // namespace
}  // namespace terrane

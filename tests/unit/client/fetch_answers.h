#pragma once
// What the tests of the fetch queue share: a collector of its answers, the options they ask with, and a wait for its
// state.

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "client/net/fetch_queue.h"

namespace terrane::testing {

/// Collects answers by name, in order of arrival; waits with a generous limit, never for a fixed time.
class Answers {
 public:
  FetchQueue::Callback as(std::string name);
  bool waitFor(std::size_t count);
  std::vector<std::string> names();
  FetchResponse response(const std::string& name);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> names_;
  std::map<std::string, FetchResponse> responses_;
};

std::unique_ptr<FetchQueue> openQueue(const std::string& url, FetchOptions options = {});

FetchOptions oneConnection();
FetchOptions quickRetry();
/// Only where a time-out is what is tested: a busy machine may well be silent for a tenth of a second.
FetchOptions impatient();

inline std::string numbered(int i) { return std::string("/").append(std::to_string(i)); }
inline std::string text(const FetchResponse& response) { return {response.body.begin(), response.body.end()}; }

/// Polls the queue's own status; for states that no callback tells.
bool waitForStatus(const FetchQueue& queue, const std::function<bool(const FetchQueue::Status&)>& reached);

}  // namespace terrane::testing

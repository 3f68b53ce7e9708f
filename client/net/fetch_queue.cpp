#include "client/net/fetch_queue.h"

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <mutex>
#include <set>
#include <thread>
#include <unordered_map>
#include <utility>

#include "client/net/http_link.h"
#include "client/net/server_url.h"
#include "client/net/slowed_http_links.h"

namespace terrane {

namespace net = boost::asio;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

namespace {

constexpr int kMaxConnections = 64;

struct Request {
  std::string target;
  double priority = 0;
  FetchQueue::Callback callback;
  Clock::time_point notBefore;
  Clock::time_point started;
  bool running = false;
  bool delayed = false;
};

/// One kept connection and the request it carries. I/O thread only.
struct Slot {
  std::shared_ptr<HttpLink> link;
  FetchQueue::Id running =
      0;  ///< 0: free. May name a request that was cancelled, while the rest of its answer is read away.
};

}  // namespace

struct FetchQueue::State {
  State(const FetchOptions& chosen, ServerUrl url)
      : options(chosen), server(std::move(url)), origin(server.origin()), timer(io), work(io.get_executor()) {
    slots.resize(static_cast<std::size_t>(std::clamp(options.connections, 1, kMaxConnections)));
    if (options.network.simulated()) slowedLinks = std::make_unique<SlowedHttpLinks>(io, options.network);
    thread = std::thread([this] { run(); });
  }

  ~State() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    io.stop();
    thread.join();
  }

  void run() {
    for (;;) {
      try {
        io.run();
        return;
      } catch (const std::exception&) {
        // Out of memory while an answer was read. Every request that was running is given up, so that none waits for
        // ever.
        abandonAll();
      }
    }
  }

  void abandonAll() {
    std::vector<Id> lost;
    for (Slot& slot : slots) {
      if (slot.link) slot.link->close();
      slot.link = nullptr;
      if (slot.running != 0) lost.push_back(std::exchange(slot.running, 0));
    }
    for (const Id id : lost) {
      FetchResponse response;
      response.error = makeError(ErrorKind::Internal, "", "out of memory");
      deliver(id, std::move(response));
    }
    pump();
  }

  void post(void (State::*step)()) {
    net::post(io, [this, step] { (this->*step)(); });
  }

  /// Starts what may start now and sets the timer for what may start later. I/O thread.
  void pump() {
    struct Start {
      std::size_t slot;
      Id id;
      std::string target;
    };
    std::vector<Start> starts;
    {
      const std::lock_guard lock(mutex);
      pumpPosted = false;
      if (stopping) return;
      const auto now = Clock::now();
      releaseDelayed(now);
      while (!ready.empty() && busySlots() + heldBack(now) < slots.size()) {
        const Id id = ready.begin()->second;
        ready.erase(ready.begin());
        Request& request = requests.at(id);
        request.running = true;
        request.started = now;
        const std::size_t slot = freeSlot();
        slots[slot].running = id;
        runningIds.insert(id);
        ++sent;
        starts.push_back({slot, id, request.target});
      }
      armTimer(now);
    }
    for (Start& start : starts) begin(start.slot, start.id, start.target);
  }

  void releaseDelayed(Clock::time_point now) {
    while (!delayed.empty() && delayed.begin()->first <= now) {
      const Id id = delayed.begin()->second;
      delayed.erase(delayed.begin());
      Request& request = requests.at(id);
      request.delayed = false;
      ready.emplace(request.priority, id);
    }
  }

  std::size_t busySlots() const {
    return static_cast<std::size_t>(
        std::count_if(slots.begin(), slots.end(), [](const Slot& slot) { return slot.running != 0; }));
  }

  /// How many connections must stay unused now: all during a pause, all but one while the server does not answer.
  std::size_t heldBack(Clock::time_point now) const {
    if (now < pausedUntil || (!reachable && now < retryAt)) return slots.size();
    return reachable ? 0 : slots.size() - 1;
  }

  /// Prefers a connection that is open already. Precondition: one is free.
  std::size_t freeSlot() const {
    std::size_t found = slots.size();
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (slots[i].running != 0) continue;
      if (slots[i].link) return i;
      found = std::min(found, i);
    }
    return found;
  }

  void armTimer(Clock::time_point now) {
    auto next = Clock::time_point::max();
    if (!delayed.empty()) next = delayed.begin()->first;
    if (!ready.empty() && now < pausedUntil) next = std::min(next, pausedUntil);
    if (!ready.empty() && !reachable && now < retryAt) next = std::min(next, retryAt);
    if (next == Clock::time_point::max()) return;
    timer.expires_at(next);
    timer.async_wait([this](const boost::system::error_code& code) {
      if (!code) pump();
    });
  }

  void begin(std::size_t slot, Id id, const std::string& target) {
    if (!slots[slot].link) {
      slots[slot].link = makeHttpLink(io, server, {options.timeout, options.maxBodyBytes, [this](std::size_t bytes) {
                                                     const std::lock_guard lock(mutex);
                                                     bytesReceived += bytes;
                                                   }});
      if (slowedLinks) slots[slot].link = slowedLinks->slowed(std::move(slots[slot].link));
      const std::lock_guard lock(mutex);
      ++connects;
    }
    slots[slot].link->get(target, [this, slot, id](HttpAnswer answer) { onAnswer(slot, id, std::move(answer)); });
  }

  void onAnswer(std::size_t slot, Id id, HttpAnswer answer) {
    const bool stale = answer.response.status == 0 && answer.bytes == 0 && slots[slot].link->used() &&
                       answer.response.error.kind == ErrorKind::Io;
    if (!answer.keep) {
      slots[slot].link->close();
      slots[slot].link = nullptr;
    }
    if (stale) {
      // The server closed a kept connection while it was idle; that is its right, and says nothing about its health.
      std::string target;
      {
        const std::lock_guard lock(mutex);
        const auto found = requests.find(id);
        if (found != requests.end()) target = found->second.target;
      }
      if (!target.empty()) return begin(slot, id, target);
    }
    {
      const std::lock_guard lock(mutex);
      slots[slot].running = 0;
      runningIds.erase(id);
      noteHealth(id, answer);
    }
    deliver(id, std::move(answer.response));
    pump();
  }

  /// Is the server alive? Under the lock.
  void noteHealth(Id id, const HttpAnswer& answer) {
    const auto now = Clock::now();
    const FetchResponse& response = answer.response;
    if (response.status != 0) {
      reachable = answered = true;
      backoff = milliseconds(0);
      lastAnswer = now;
      lastError.clear();
      if (response.status == 503 && response.retryAfter.count() > 0) {
        pausedUntil = std::max(pausedUntil, now + response.retryAfter);
        lastError = "the server is busy";
      }
      return;
    }
    const auto found = requests.find(id);
    if (found == requests.end()) return;  // cancelled: nobody waited for it
    lastError = response.error.text();
    if (response.error.kind == ErrorKind::TooLarge) return;
    // Others were answered since this one began: then it is this request, not the server.
    if (lastAnswer > found->second.started) return;
    // A failure of a request older than the present pause tells nothing new.
    if (!reachable && found->second.started < unreachableSince) return;
    backoff = std::clamp(backoff * 2, options.firstBackoff, std::max(options.firstBackoff, options.longestBackoff));
    reachable = false;
    unreachableSince = now;
    retryAt = now + backoff;
  }

  void deliver(Id id, FetchResponse response) {
    Callback callback;
    {
      const std::lock_guard lock(mutex);
      const auto found = requests.find(id);
      if (found == requests.end()) return;
      callback = std::move(found->second.callback);
      requests.erase(found);
    }
    callback(std::move(response));
  }

  void abandon(Id id) {
    for (Slot& slot : slots) {
      if (slot.running != id) continue;
      if (slot.link->cheapToFinish()) return;
      slot.link->close();
      slot.link = nullptr;
      const std::lock_guard lock(mutex);
      slot.running = 0;
      runningIds.erase(id);
    }
    pump();
  }

  /// Under the lock.
  void pumpSoon() {
    if (!std::exchange(pumpPosted, true)) post(&State::pump);
  }

  const FetchOptions options;
  const ServerUrl server;
  const std::string origin;

  // I/O thread only (the slots' running ids are written under the lock).
  net::io_context io{1};
  net::steady_timer timer;
  net::executor_work_guard<net::io_context::executor_type> work;
  std::unique_ptr<SlowedHttpLinks> slowedLinks;  ///< null: nothing to simulate
  std::vector<Slot> slots;

  mutable std::mutex mutex;
  bool stopping = false, pumpPosted = false;
  Id nextId = 1;
  std::unordered_map<Id, Request> requests;  ///< queued and running
  std::set<std::pair<double, Id>> ready;
  std::set<std::pair<Clock::time_point, Id>> delayed;
  std::set<Id> runningIds;  ///< on a connection, cancelled ones included
  std::uint64_t sent = 0, bytesReceived = 0, connects = 0;
  bool answered = false, reachable = true;
  Clock::time_point lastAnswer, unreachableSince, retryAt, pausedUntil;
  milliseconds backoff{0};
  std::string lastError;

  std::thread thread;
};

FetchQueue::FetchQueue(std::unique_ptr<State> state) : state_(std::move(state)) {}
FetchQueue::~FetchQueue() = default;

Result<std::unique_ptr<FetchQueue>> FetchQueue::open(const FetchOptions& options) {
  auto server = parseServerUrl(options.serverUrl);
  if (!server) return server.error();
  try {
    return std::unique_ptr<FetchQueue>(new FetchQueue(std::make_unique<State>(options, std::move(*server))));
  } catch (const std::exception& failure) {
    return makeError(ErrorKind::Internal, "--server",
                     std::string("cannot start the network thread: ") + failure.what());
  }
}

FetchQueue::Id FetchQueue::fetch(std::string target, double priority, Callback callback, milliseconds delay) {
  const std::lock_guard lock(state_->mutex);
  const Id id = state_->nextId++;
  Request request{std::move(target), priority, std::move(callback), Clock::now() + delay, {}, false, delay.count() > 0};
  if (request.delayed) {
    state_->delayed.emplace(request.notBefore, id);
  } else {
    state_->ready.emplace(priority, id);
  }
  state_->requests.emplace(id, std::move(request));
  state_->pumpSoon();
  return id;
}

void FetchQueue::setPriority(Id id, double priority) {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->requests.find(id);
  if (found == state_->requests.end() || found->second.running) return;
  if (!found->second.delayed) {
    state_->ready.erase({found->second.priority, id});
    state_->ready.emplace(priority, id);
  }
  found->second.priority = priority;
}

bool FetchQueue::cancel(Id id) {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->requests.find(id);
  if (found == state_->requests.end()) return false;
  if (found->second.running) {
    net::post(state_->io, [state = state_.get(), id] { state->abandon(id); });
  } else if (found->second.delayed) {
    state_->delayed.erase({found->second.notBefore, id});
  } else {
    state_->ready.erase({found->second.priority, id});
  }
  state_->requests.erase(found);
  return true;
}

FetchQueue::Status FetchQueue::status() const {
  const std::lock_guard lock(state_->mutex);
  const auto now = Clock::now();
  Status status;
  status.queued = state_->ready.size() + state_->delayed.size();
  status.running = state_->runningIds.size();
  status.requests = state_->sent;
  status.bytesReceived = state_->bytesReceived;
  status.connects = state_->connects;
  status.answered = state_->answered;
  status.reachable = state_->reachable;
  const auto until = std::max(state_->pausedUntil, state_->reachable ? Clock::time_point() : state_->retryAt);
  if (until > now) status.retryIn = std::chrono::ceil<milliseconds>(until - now);
  for (const Id id : state_->runningIds) {
    const auto found = state_->requests.find(id);
    if (found == state_->requests.end()) continue;
    status.longestRunning =
        std::max(status.longestRunning, std::chrono::floor<milliseconds>(now - found->second.started));
  }
  status.lastError = state_->lastError;
  return status;
}

const std::string& FetchQueue::origin() const { return state_->origin; }

}  // namespace terrane

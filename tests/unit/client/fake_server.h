#pragma once
// An HTTP/1.1 server of a few lines for the tests, on an ephemeral loopback port: a thread a connection, answers from a
// function of the target, and every misbehaviour a viewer may meet: silence, refusal, nonsense, half an answer.

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace terrane::testing {

struct FakeReply {
  int status = 200;
  std::string body = {};
  std::string headers = {};  ///< whole lines, each ended by CR LF
  bool hold = false;         ///< answer only after release()
  bool holdHalfway = false;  ///< the header and half the body at once, the rest only after release()
  bool closeAfter = false;   ///< close without saying so beforehand
  std::string raw = {};      ///< if not empty: sent instead of an answer, then the connection is closed
};

class FakeServer {
 public:
  using Handler = std::function<FakeReply(const std::string& target)>;

  /// Port 0 picks one. The handler runs on connection threads, one call at a time.
  explicit FakeServer(Handler handler, int port = 0);
  ~FakeServer();

  int port() const { return port_; }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }

  /// Lets the next count held answers go, in order of arrival.
  void release(int count);
  void releaseAll();

  std::vector<std::string> targets() const;  ///< in order of arrival
  int connections() const;                   ///< accepted so far
  int abandoned() const;                     ///< closed by the client before it had the whole answer
  int holding() const;

  /// Wait for a state; false after a generous time.
  bool waitForRequests(std::size_t count) const;
  bool waitForHolding(int count) const;
  bool waitForAbandoned(int count) const;

 private:
  void accept();
  void serve(int socket);
  bool answer(int socket, const std::string& target);
  /// False if the client went away or the server stops.
  bool holdBack(int socket);
  bool send(int socket, const std::string& text);
  bool waitUntil(const std::function<bool()>& reached) const;

  Handler handler_;
  int port_ = 0, listener_ = -1, stopPipe_[2] = {-1, -1};
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::mutex handlerMutex_;
  std::vector<std::string> targets_;
  std::set<std::uint64_t> held_;
  std::uint64_t nextHold_ = 0;
  int allowed_ = 0, connections_ = 0, abandoned_ = 0;
  bool stopping_ = false, allReleased_ = false;
  std::list<std::thread> threads_;
  std::thread acceptor_;
};

/// A port that nothing listens on (it was free a moment ago).
int unusedPort();

}  // namespace terrane::testing

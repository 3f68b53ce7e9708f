#pragma once
// HTTP/1.1 over Boost.Beast and Asio: listeners, sessions, time limits, graceful stop. I/O threads only move bytes. A
// connection belongs to one I/O thread for its life, so a session takes no lock.
//
// What comes from outside is bounded: header bytes (431), target (414), bodies (413; GET needs none), time to send a
// header (408), time between requests, time for a peer to take bytes, connections (503). A client that goes away while
// its tile waits to be built withdraws the wait; one that has only closed its sending side is answered.

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "common/result.h"
#include "server/http/tile_service.h"

namespace terrane {

struct ServerOptions {
  std::vector<std::string> listen{"127.0.0.1:8080"};  ///< HOST:PORT, [V6]:PORT; port 0 picks one
  int ioThreads = 1;
  std::chrono::milliseconds headerTimeout{
      10'000};  ///< from the connection's start, then from a header's first byte, to its end
  std::chrono::milliseconds idleTimeout{60'000};      ///< between requests of a kept connection
  std::chrono::milliseconds writeTimeout{30'000};     ///< without a byte of the response being taken
  std::chrono::milliseconds responseTimeout{60'000};  ///< for a build to be done: 503 then
  std::size_t maxHeaderBytes = 8192;
  std::size_t maxConnections = 4096;
  std::chrono::milliseconds shutdownGrace{5'000};  ///< what is under way may finish
};

class HttpServer {
 public:
  /// Binds and listens; serves once run() is called. Errors name "--listen" (InvalidArgument, Io: port in use). The
  /// service must outlive the server.
  static Result<std::unique_ptr<HttpServer>> open(const ServerOptions& options, TileService& service);
  ~HttpServer();

  /// "http://127.0.0.1:8080", one for each listener, with the port that was picked.
  std::vector<std::string> urls() const;
  /// Blocks until stop() has been called and connections are done or the grace is over. Once.
  void run();
  /// From any thread (not from a signal handler proper: it takes locks). Idle connections close at once. Also before
  /// run().
  void stop();
  std::size_t connections() const noexcept;

 private:
  struct State;
  explicit HttpServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane

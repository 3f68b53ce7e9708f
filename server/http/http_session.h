#pragma once
// What the HTTP server's coroutines work on: an I/O thread, its sessions, and the reading of their input. Everything
// here belongs to one I/O thread and takes no lock. Included by http_session.cpp and http_server.cpp alone; apart from
// them so that the coroutines, which are slow to compile, stay few.

#include <array>
#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstring>
#include <list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/http/http_date.h"
#include "server/http/http_server.h"
#include "server/http/request_parser.h"

namespace terrane::http {

namespace net = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using Executor = net::io_context::executor_type;
using Tcp = net::ip::tcp;
using Socket = net::basic_stream_socket<Tcp, Executor>;
using Acceptor = net::basic_socket_acceptor<Tcp, Executor>;
using Timer = net::basic_waitable_timer<Clock, net::wait_traits<Clock>, Executor>;

/// How long a peer may go on sending after it was told that the connection closes.
inline constexpr std::chrono::milliseconds kLingerTimeout{1'000};

struct Session;

/// One I/O thread: its sessions, and one timer that looks for those whose time is over. That costs a session two reads
/// of the clock a request, where a timer for each operation would cost several heap operations.
struct IoThread {
  IoThread(const ServerOptions& o, TileService& s) : options(o), service(s) {}

  const ServerOptions& options;
  TileService& service;
  std::list<Session*> sessions;
  HeadEndings endings;
  bool stopping = false;
  bool tickArmed = false;
  Clock::time_point graceEnd{};
  std::atomic<std::size_t> connections{0};
  net::io_context context{1};  // destroyed before all of the above: suspended sessions end with it
  std::optional<net::executor_work_guard<Executor>> work{context.get_executor()};
  Timer tick{context};

  void run();
  void armTick();
  void checkDeadlines();
  void beginStop();
};

/// A response that is being made. Touched by its I/O thread only.
struct Pending {
  std::optional<ServiceResponse> response;
  Session* waiter = nullptr;
  bool peerGone = false;
};

/// One connection.
///   Starting -> Reading -> Waiting -> Writing -> Idle -> Reading ...
///        any of them -> Closing (what the peer still sends is read and thrown away)
struct Session {
  enum class Phase { Starting, Idle, Reading, Waiting, Writing, Closing };

  Session(IoThread& thread, Socket s)
      : io(thread), socket(std::move(s)), wake(thread.context), input(thread.options.maxHeaderBytes) {
    position = io.sessions.insert(io.sessions.end(), this);
    enter(Phase::Starting, io.options.headerTimeout);
    io.armTick();
  }
  ~Session() {  // NOLINT(bugprone-exception-escape): cancelling a timer does not throw on any system we run on
    io.sessions.erase(position);
    if (io.stopping && io.sessions.empty()) io.tick.cancel();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void enter(Phase next, std::chrono::milliseconds limit) {
    phase = next;
    timedOut = false;
    deadline = Clock::now() + limit;
  }
  /// Ends whatever the session waits for; it then looks at timedOut, closed and the thread's stopping.
  void interrupt() {
    error_code ignored;
    if (socket.is_open()) socket.cancel(ignored);
    wake.cancel();
  }
  void close() {
    closed = true;
    error_code ignored;
    socket.close(ignored);
    wake.cancel();
  }
  bool betweenRequests() const { return phase == Phase::Idle || phase == Phase::Starting; }
  void consume(std::size_t bytes) {
    used -= bytes;
    if (used > 0 && bytes > 0) std::memmove(input.data(), input.data() + bytes, used);
  }

  IoThread& io;
  Socket socket;
  Timer wake;
  std::list<Session*>::iterator position;
  Phase phase = Phase::Starting;
  Clock::time_point deadline{};
  bool timedOut = false;
  bool closed = false;
  std::vector<char> input;  ///< the first `used` bytes: read, not yet parsed
  std::size_t used = 0;
  std::size_t headerBytes = 0;
  int emptyLines = 0;
  std::size_t bytesAhead = 0;  ///< of the answer that is being made: sent already
  RequestFields fields;
  std::optional<RequestParser> parser;
  std::string ending;
};

enum class ReadOutcome { Request, Closed, TimedOut, LineTooLong, HeaderTooLarge, BadVersion, Malformed };

/// Throws away empty lines before a request (RFC 9112 section 2.2), a few; true if what is left begins one. They count
/// for nothing: a client that sends them is still between requests.
bool beginsRequest(Session& session);

/// Parses what has been read; empty when more is needed.
std::optional<ReadOutcome> parseInput(Session& session);

/// What the HTTP layer refuses by itself. Such a connection is closed, since where its next request begins is not
/// known.
std::optional<ServiceResponse> refusal(const Session& session, ReadOutcome outcome);

}  // namespace terrane::http

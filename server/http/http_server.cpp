#include "server/http/http_server.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <ctime>
#include <exception>
#include <list>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "server/http/http_session.h"
#include "server/http/listen_address.h"
#include "server/http/problem.h"

namespace terrane {
namespace {

using namespace http;
template <class T>
using Task = net::awaitable<T, Executor>;
constexpr auto kErrorAndValue = net::as_tuple(net::use_awaitable_t<Executor>{});

constexpr std::chrono::milliseconds kAcceptBackoff{100};
constexpr std::size_t kMaxLingerBytes = 256 * 1024;
constexpr std::string_view kEveryAnswerBegins = "HTTP/1.1 ";

HeadEndings::Connection connectionField(const Session& session, bool keep) {
  if (!keep) return HeadEndings::Connection::Closed;
  return session.fields.version == 10 ? HeadEndings::Connection::Kept : HeadEndings::Connection::KeptByDefault;
}

using Buffers = std::array<net::const_buffer, 3>;

/// True when nothing is left.
bool advance(Buffers& buffers, std::size_t bytes) {
  bool empty = true;
  for (net::const_buffer& buffer : buffers) {
    const std::size_t taken = std::min(bytes, buffer.size());
    buffer += taken;
    bytes -= taken;
    empty = empty && buffer.size() == 0;
  }
  return empty;
}

Task<bool> writeRest(Session& session, Buffers buffers) {
  for (;;) {
    session.enter(Session::Phase::Writing, session.io.options.writeTimeout);
    const auto [failure, bytes] = co_await session.socket.async_write_some(buffers, kErrorAndValue);
    if (failure || session.closed) co_return false;
    if (advance(buffers, bytes)) co_return true;
  }
}

/// Sends the response; a body is sent from where it lies. Mostly the socket takes all at once and nothing is awaited.
Task<bool> writeResponse(Session& session, const ServiceResponse& response, bool withBody, bool keep) {
  const std::string head = response.tile ? std::string() : responseHead(response, response.body.size());
  const std::string& headText = response.tile ? response.tile->head : head;
  session.ending = session.io.endings.at(std::time(nullptr), connectionField(session, keep));
  Buffers buffers{net::buffer(headText), net::buffer(session.ending), net::const_buffer()};
  if (withBody) buffers[2] = response.tile ? net::buffer(response.tile->glb) : net::buffer(response.body);
  advance(buffers, std::exchange(session.bytesAhead, 0));
  error_code failure;
  const std::size_t bytes = session.socket.write_some(buffers, failure);
  if (failure && failure != net::error::would_block) co_return false;
  if (advance(buffers, failure ? 0 : bytes)) co_return true;
  co_return co_await writeRest(session, buffers);
}

Task<ReadOutcome> readRequest(Session& session) {
  const ServerOptions& options = session.io.options;
  session.parser.emplace(session.fields);
  session.parser->header_limit(static_cast<std::uint32_t>(options.maxHeaderBytes));
  session.headerBytes = 0;
  session.emptyLines = 0;
  for (;;) {
    if (beginsRequest(session)) {
      if (session.betweenRequests()) session.enter(Session::Phase::Reading, options.headerTimeout);
      if (const auto outcome = parseInput(session)) co_return *outcome;
    }
    if (session.closed || (session.io.stopping && session.betweenRequests())) co_return ReadOutcome::Closed;
    const auto [failure, bytes] = co_await session.socket.async_read_some(
        net::buffer(session.input.data() + session.used, session.input.size() - session.used), kErrorAndValue);
    if (failure) {
      const bool halfSent = session.phase == Session::Phase::Reading;
      co_return session.timedOut&& halfSent ? ReadOutcome::TimedOut : ReadOutcome::Closed;
    }
    session.used += bytes;
  }
}

void letGo(Pending& pending) {
  pending.peerGone = true;
  pending.waiter->wake.cancel();
}

/// A peer that sends no more may still wait for its answer, or be gone. The bytes that every answer begins with tell:
/// one that is gone resets the connection.
void probePeer(Session& session, const std::shared_ptr<Pending>& pending) {
  error_code failure;
  session.bytesAhead = session.socket.write_some(net::buffer(kEveryAnswerBegins), failure);
  if (failure && failure != net::error::would_block) return letGo(*pending);
  session.socket.async_wait(Socket::wait_error, [pending](error_code stopped) {
    if (!stopped && pending->waiter) letGo(*pending);
  });
}

/// Notices a peer that goes away while its tile is being built. Bytes of a next request end the watch.
void watchPeer(Session& session, const std::shared_ptr<Pending>& pending) {
  session.socket.async_wait(Socket::wait_read, [pending](error_code failure) {
    Session* const waiter = pending->waiter;
    if (failure || !waiter) return;
    char byte = 0;
    waiter->socket.receive(net::buffer(&byte, 1), Socket::message_peek, failure);
    if (!failure) return;
    if (failure == net::error::would_block) return watchPeer(*waiter, pending);
    if (failure == net::error::eof) return probePeer(*waiter, pending);
    letGo(*pending);
  });
}

/// Until there is a response, the peer is gone, or time is over.
Task<void> waitForResponse(Session& session, const std::shared_ptr<Pending>& pending) {
  session.enter(Session::Phase::Waiting, session.io.options.responseTimeout);
  pending->waiter = &session;
  watchPeer(session, pending);
  while (!pending->response && !pending->peerGone && !session.timedOut && !session.closed) {
    session.wake.expires_at(Clock::time_point::max());
    co_await session.wake.async_wait(kErrorAndValue);
  }
  pending->waiter = nullptr;
  error_code ignored;
  session.socket.cancel(ignored);
}

/// Empty when nobody is left to answer.
Task<std::optional<ServiceResponse>> respond(Session& session, const std::shared_ptr<IoThread>& io) {
  const auto pending = std::make_shared<Pending>();
  // The reply may come from a worker, even as the last thing that still knows this I/O thread: so it shares it.
  const auto ticket = io->service.handle({session.fields.method, session.fields.target, session.fields.ifNoneMatch},
                                         [pending, io](ServiceResponse response) {
                                           if (io->context.get_executor().running_in_this_thread()) {
                                             pending->response = std::move(response);
                                             return;
                                           }
                                           net::post(io->context, [pending, response = std::move(response)]() mutable {
                                             pending->response = std::move(response);
                                             if (pending->waiter) pending->waiter->wake.cancel();
                                           });
                                         });
  if (!pending->response) co_await waitForResponse(session, pending);
  if (!pending->response && session.timedOut && !session.closed)
    pending->response = problemResponse(makeError(ErrorKind::Timeout, "", "the tile was not built in time"), 503,
                                        session.fields.target);
  co_return std::move(pending->response);
}

/// Closes so that the peer can still read what it was sent: a socket closed on unread input resets the connection.
Task<void> linger(Session& session) {
  error_code failure;
  session.socket.shutdown(Socket::shutdown_send, failure);
  session.enter(Session::Phase::Closing, kLingerTimeout);
  for (std::size_t thrownAway = 0; !failure && !session.timedOut && !session.closed && thrownAway < kMaxLingerBytes;) {
    const auto [readFailure, bytes] =
        co_await session.socket.async_read_some(net::buffer(session.input), kErrorAndValue);
    failure = readFailure;
    thrownAway += bytes;
  }
}

Task<void> serveConnection(std::weak_ptr<IoThread> thread, Socket socket) {
  // Held by the callbacks of requests only: a session that kept its thread alive would never be destroyed with it.
  IoThread& io = *thread.lock();
  Session session(io, std::move(socket));
  for (;;) {
    const ReadOutcome outcome = co_await readRequest(session);
    if (outcome == ReadOutcome::Closed) co_return;
    std::optional<ServiceResponse> response = refusal(session, outcome);
    const bool refused = response.has_value();
    if (!refused) response = co_await respond(session, thread.lock());
    if (!response || session.closed) co_return;

    const bool readable = outcome == ReadOutcome::Request;
    const bool hasBody = readable && !session.parser->is_done();
    const bool keep = !refused && !hasBody && !io.stopping && session.parser->keep_alive();
    const bool withBody = !readable || session.fields.method != HttpMethod::Head;
    if (!co_await writeResponse(session, *response, withBody, keep)) co_return;
    if (!keep) co_return co_await linger(session);
    session.enter(Session::Phase::Idle, io.options.idleTimeout);
  }
}

/// For a connection beyond the limit: one answer if the socket takes it, and good-bye.
void turnAway(Socket socket) {
  const ServiceResponse response =
      problemResponse(makeError(ErrorKind::Overloaded, "", "too many connections"), 503, "");
  const std::string text = responseHead(response, response.body.size()) + "Connection: close\r\n\r\n" + response.body;
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(net::buffer(text), ignored);
  socket.shutdown(Socket::shutdown_send, ignored);
}

void logEnd(const std::exception_ptr& failure) {
  if (!failure) return;
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    spdlog::error("a connection ended: {}", error.what());
  }
}

Result<Tcp::endpoint> resolve(const ListenAddress& wanted, net::io_context& context) {
  error_code failure;
  const net::ip::address address = net::ip::make_address(wanted.host, failure);
  if (!failure) return Tcp::endpoint(address, wanted.port);
  Tcp::resolver resolver(context);
  const auto found = resolver.resolve(wanted.host, std::to_string(wanted.port), Tcp::resolver::passive, failure);
  if (failure || found.empty())
    return makeError(ErrorKind::Io, "--listen",
                     fmt::format("\"{}\" cannot be resolved: {}", wanted.host, failure.message()));
  for (const auto& entry : found)
    if (entry.endpoint().address().is_v4()) return entry.endpoint();
  return found.begin()->endpoint();
}

}  // namespace

struct HttpServer::State {
  ServerOptions options;
  std::vector<std::shared_ptr<IoThread>> threads;
  std::list<Acceptor> acceptors;  // of the first thread
  std::atomic<bool> stopRequested{false};
  std::size_t nextThread = 0;
  Clock::time_point lastComplaint{};

  Result<void> listen(std::string_view text);
  Task<void> acceptConnections(Acceptor& acceptor);
  void take(const std::shared_ptr<IoThread>& io, Socket socket);
  std::size_t connections() const;
};

Result<void> HttpServer::State::listen(std::string_view text) {
  const Result<ListenAddress> wanted = parseListenAddress(text);
  if (!wanted) return wanted.error();
  const Result<Tcp::endpoint> endpoint = resolve(*wanted, threads[0]->context);
  if (!endpoint) return endpoint.error();
  Acceptor acceptor(threads[0]->context);
  error_code failure;
  acceptor.open(endpoint->protocol(), failure);
  if (!failure) acceptor.set_option(Acceptor::reuse_address(true), failure);
  if (!failure && endpoint->protocol() == Tcp::v6()) acceptor.set_option(net::ip::v6_only(true), failure);
  if (!failure) acceptor.bind(*endpoint, failure);
  if (!failure) acceptor.listen(Acceptor::max_listen_connections, failure);
  if (failure)
    return makeError(ErrorKind::Io, "--listen",
                     fmt::format("cannot listen on {}: {}{}", text, failure.message(),
                                 failure == net::error::address_in_use
                                     ? " (another program serves this port; port 0 picks a free one)"
                                     : ""));
  acceptors.push_back(std::move(acceptor));
  return {};
}

std::size_t HttpServer::State::connections() const {
  std::size_t count = 0;
  for (const auto& io : threads) count += io->connections;
  return count;
}

void HttpServer::State::take(const std::shared_ptr<IoThread>& io, Socket socket) {
  if (connections() >= options.maxConnections) return turnAway(std::move(socket));
  error_code ignored;
  socket.set_option(Tcp::no_delay(true), ignored);
  socket.non_blocking(true, ignored);
  ++io->connections;
  net::co_spawn(io->context, serveConnection(io, std::move(socket)),
                [thread = io.get()](const std::exception_ptr& failure) {
                  --thread->connections;
                  logEnd(failure);
                });
}

/// Nothing that goes wrong with one connection, nor a lack of file descriptors, ends this.
Task<void> HttpServer::State::acceptConnections(Acceptor& acceptor) {
  const IoThread& own = *threads[0];
  Timer pause(threads[0]->context);
  while (!own.stopping) {
    const std::size_t chosen = nextThread++ % threads.size();
    auto [failure, socket] = co_await acceptor.async_accept(threads[chosen]->context, kErrorAndValue);
    if (own.stopping || !acceptor.is_open()) co_return;
    if (!failure) {
      take(threads[chosen], std::move(socket));
    } else if (failure != net::error::connection_aborted) {
      if (const auto now = Clock::now(); now - lastComplaint > std::chrono::seconds(10)) {
        lastComplaint = now;
        spdlog::warn("cannot accept connections for now: {}", failure.message());
      }
      pause.expires_after(kAcceptBackoff);
      co_await pause.async_wait(kErrorAndValue);
    }
  }
}

HttpServer::HttpServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

HttpServer::~HttpServer() = default;

Result<std::unique_ptr<HttpServer>> HttpServer::open(const ServerOptions& options, TileService& service) try {
  auto state = std::make_unique<State>();
  state->options = options;
  for (int i = 0; i < std::max(1, options.ioThreads); ++i)
    state->threads.push_back(std::make_shared<IoThread>(state->options, service));
  if (options.listen.empty())
    return makeError(ErrorKind::InvalidArgument, "--listen", "at least one HOST:PORT is needed");
  for (const std::string& text : options.listen)
    if (Result<void> listening = state->listen(text); !listening) return std::move(listening).error();
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(state)));
} catch (const std::exception& error) {
  return makeError(ErrorKind::Io, "--listen", error.what());
}

std::vector<std::string> HttpServer::urls() const {
  std::vector<std::string> urls;
  for (const Acceptor& acceptor : state_->acceptors) {
    error_code failure;
    const Tcp::endpoint endpoint = acceptor.local_endpoint(failure);
    if (failure) continue;
    const std::string host = endpoint.address().to_string();
    urls.push_back(fmt::format(fmt::runtime(endpoint.address().is_v6() ? "http://[{}]:{}" : "http://{}:{}"), host,
                               endpoint.port()));
  }
  return urls;
}

void HttpServer::run() {
  for (Acceptor& acceptor : state_->acceptors)
    net::co_spawn(state_->threads[0]->context, state_->acceptConnections(acceptor), logEnd);
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < state_->threads.size(); ++i)
    others.emplace_back([io = state_->threads[i]] { io->run(); });
  state_->threads[0]->run();
  for (std::thread& thread : others) thread.join();
}

void HttpServer::stop() {
  if (state_->stopRequested.exchange(true)) return;
  for (const std::shared_ptr<IoThread>& io : state_->threads) {
    net::post(io->context, [this, thread = io.get()] {
      if (thread == state_->threads[0].get()) {
        error_code ignored;
        for (Acceptor& acceptor : state_->acceptors) acceptor.close(ignored);
      }
      thread->beginStop();
    });
  }
}

std::size_t HttpServer::connections() const noexcept { return state_->connections(); }

}  // namespace terrane

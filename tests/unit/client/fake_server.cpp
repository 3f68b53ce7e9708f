#include "tests/unit/client/fake_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>

namespace terrane::testing {
namespace {

constexpr std::chrono::seconds kGenerous{60};

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

int boundSocket(int port, int& boundPort) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address = loopback(port);
  if (::bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot bind");
  socklen_t size = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  boundPort = ntohs(address.sin_port);
  return socket;
}

bool sendAll(int socket, const std::string& text) {
  std::size_t sent = 0;
  while (sent < text.size()) {
    const auto count = ::send(socket, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

int unusedPort() {
  int port = 0;
  ::close(boundSocket(0, port));
  return port;
}

FakeServer::FakeServer(Handler handler, int port) : handler_(std::move(handler)) {
  listener_ = boundSocket(port, port_);
  if (::listen(listener_, 64) != 0 || ::pipe(stopPipe_) != 0) throw std::runtime_error("cannot listen");
  acceptor_ = std::thread([this] { accept(); });
}

FakeServer::~FakeServer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  // Nobody reads from the pipe: it stays readable for every thread that polls it.
  [[maybe_unused]] const auto written = ::write(stopPipe_[1], "x", 1);
  changed_.notify_all();
  acceptor_.join();
  for (std::thread& thread : threads_) thread.join();
  ::close(listener_);
  ::close(stopPipe_[0]);
  ::close(stopPipe_[1]);
}

void FakeServer::accept() {
  for (;;) {
    std::array<pollfd, 2> waiting{pollfd{listener_, POLLIN, 0}, pollfd{stopPipe_[0], POLLIN, 0}};
    ::poll(waiting.data(), waiting.size(), -1);
    if (waiting[1].revents) return;
    const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) continue;
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    const std::lock_guard lock(mutex_);
    ++connections_;
    threads_.emplace_back([this, socket] { serve(socket); });
  }
}

void FakeServer::serve(int socket) {
  std::string received;
  for (bool open = true; open;) {
    const std::size_t end = received.find("\r\n\r\n");
    if (end != std::string::npos) {
      const std::size_t first = received.find(' '), second = received.find(' ', first + 1);
      const std::string target = received.substr(first + 1, second - first - 1);
      received.erase(0, end + 4);
      open = answer(socket, target);
      continue;
    }
    std::array<pollfd, 2> waiting{pollfd{socket, POLLIN, 0}, pollfd{stopPipe_[0], POLLIN, 0}};
    ::poll(waiting.data(), waiting.size(), -1);
    if (waiting[1].revents) break;
    std::array<char, 4096> chunk{};
    const auto count = ::recv(socket, chunk.data(), chunk.size(), 0);
    if (count <= 0) break;
    received.append(chunk.data(), static_cast<std::size_t>(count));
  }
  ::close(socket);
}

bool FakeServer::answer(int socket, const std::string& target) {
  FakeReply reply;
  {
    const std::lock_guard once(handlerMutex_);
    reply = handler_(target);
    const std::lock_guard lock(mutex_);
    targets_.push_back(target);
  }
  changed_.notify_all();
  if (reply.hold && !holdBack(socket)) return false;
  if (!reply.raw.empty()) {
    sendAll(socket, reply.raw);
    return false;
  }
  const std::string answer = "HTTP/1.1 " + std::to_string(reply.status) +
                             " X\r\nContent-Length: " + std::to_string(reply.body.size()) + "\r\n" + reply.headers +
                             "\r\n" + reply.body;
  const std::size_t first = answer.size() - (reply.holdHalfway ? reply.body.size() / 2 : 0);
  if (!send(socket, answer.substr(0, first))) return false;
  if (reply.holdHalfway && !(holdBack(socket) && send(socket, answer.substr(first)))) return false;
  return !reply.closeAfter;
}

/// A client may close before it was sent all that is not held back.
bool FakeServer::send(int socket, const std::string& text) {
  if (sendAll(socket, text)) return true;
  {
    const std::lock_guard lock(mutex_);
    ++abandoned_;
  }
  changed_.notify_all();
  return false;
}

bool FakeServer::holdBack(int socket) {
  std::unique_lock lock(mutex_);
  const std::uint64_t ticket = nextHold_++;
  held_.insert(ticket);
  changed_.notify_all();
  bool stays = true;
  for (;;) {
    if (stopping_) {
      stays = false;
      break;
    }
    if (allReleased_ || (allowed_ > 0 && *held_.begin() == ticket)) {
      allowed_ -= allReleased_ ? 0 : 1;
      break;
    }
    pollfd peer{socket, POLLIN | POLLRDHUP, 0};
    if (::poll(&peer, 1, 0) > 0 && (peer.revents & (POLLRDHUP | POLLHUP | POLLERR))) {
      ++abandoned_;
      stays = false;
      break;
    }
    changed_.wait_for(lock, std::chrono::milliseconds(2));
  }
  held_.erase(ticket);
  changed_.notify_all();
  return stays;
}

void FakeServer::release(int count) {
  const std::lock_guard lock(mutex_);
  allowed_ += count;
  changed_.notify_all();
}

void FakeServer::releaseAll() {
  const std::lock_guard lock(mutex_);
  allReleased_ = true;
  changed_.notify_all();
}

std::vector<std::string> FakeServer::targets() const {
  const std::lock_guard lock(mutex_);
  return targets_;
}

int FakeServer::connections() const {
  const std::lock_guard lock(mutex_);
  return connections_;
}

int FakeServer::abandoned() const {
  const std::lock_guard lock(mutex_);
  return abandoned_;
}

int FakeServer::holding() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(held_.size());
}

bool FakeServer::waitUntil(const std::function<bool()>& reached) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kGenerous, reached);
}

bool FakeServer::waitForRequests(std::size_t count) const {
  return waitUntil([&] { return targets_.size() >= count; });
}

bool FakeServer::waitForHolding(int count) const {
  return waitUntil([&] { return static_cast<int>(held_.size()) >= count; });
}

bool FakeServer::waitForAbandoned(int count) const {
  return waitUntil([&] { return abandoned_ >= count; });
}

}  // namespace terrane::testing

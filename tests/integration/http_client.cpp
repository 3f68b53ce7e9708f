#include "tests/integration/http_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>

namespace terrane::test {
namespace {

/// The address of "http://HOST:PORT"; length 0 if it is none.
socklen_t parseUrl(std::string_view url, sockaddr_storage& storage) {
  url.remove_prefix(std::min(url.size(), std::string_view("http://").size()));
  const std::size_t colon = url.rfind(':');
  if (colon == std::string_view::npos) return 0;
  std::string host(url.substr(0, colon));
  std::uint16_t port = 0;
  const std::string_view portText = url.substr(colon + 1);
  std::from_chars(portText.data(), portText.data() + portText.size(), port);
  std::memset(&storage, 0, sizeof storage);
  if (host.starts_with('[')) {
    auto& v6 = reinterpret_cast<sockaddr_in6&>(storage);
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    return inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &v6.sin6_addr) == 1 ? sizeof v6 : 0;
  }
  auto& v4 = reinterpret_cast<sockaddr_in&>(storage);
  v4.sin_family = AF_INET;
  v4.sin_port = htons(port);
  return inet_pton(AF_INET, host.c_str(), &v4.sin_addr) == 1 ? sizeof v4 : 0;
}

}  // namespace

HttpConnection::HttpConnection(std::string_view url) {
  sockaddr_storage address{};
  const socklen_t length = parseUrl(url, address);
  if (length == 0) return;
  socket_ = ::socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval limit{10, 0};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  const int on = 1;
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), length) != 0) close();
}

HttpConnection::~HttpConnection() { close(); }

void HttpConnection::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

void HttpConnection::abort() {
  const linger reset{1, 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
  close();
}

void HttpConnection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // the server may refuse what it has not read; its answer tells
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

void HttpConnection::shutdownSend() { ::shutdown(socket_, SHUT_WR); }

bool HttpConnection::fill() {
  char buffer[65536];
  const ssize_t got = ::recv(socket_, buffer, sizeof buffer, 0);
  if (got <= 0) return false;
  input_.append(buffer, static_cast<std::size_t>(got));
  return true;
}

bool HttpConnection::closedByServer() {
  char byte = 0;
  return input_.empty() && ::recv(socket_, &byte, 1, 0) == 0;
}

MaybeAnswer HttpConnection::read(bool withBody) {
  std::size_t end = std::string::npos;
  while ((end = input_.find("\r\n\r\n")) == std::string::npos)
    if (!fill()) return {};
  const std::string head = input_.substr(0, end + 2);
  input_.erase(0, end + 4);

  HttpAnswer answer;
  if (!head.starts_with("HTTP/1.1 ")) return {};
  std::from_chars(head.data() + 9, head.data() + 12, answer.status);
  for (std::size_t line = head.find("\r\n") + 2; line < head.size();) {
    const std::size_t next = head.find("\r\n", line);
    const std::size_t colon = head.find(": ", line);
    std::string name = head.substr(line, colon - line);
    std::ranges::transform(name, name.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    answer.fields[name] = head.substr(colon + 2, next - colon - 2);
    line = next + 2;
  }
  std::size_t length = 0;
  if (const auto field = answer.fields.find("content-length"); field != answer.fields.end() && withBody)
    std::from_chars(field->second.data(), field->second.data() + field->second.size(), length);
  while (input_.size() < length)
    if (!fill()) return {};
  answer.body = input_.substr(0, length);
  input_.erase(0, length);
  return answer;
}

MaybeAnswer HttpConnection::request(std::string_view target, std::string_view method, std::string_view header) {
  std::string text(method);
  text.append(" ").append(target).append(" HTTP/1.1\r\nHost: localhost\r\n").append(header).append("\r\n");
  send(text);
  return read(method != "HEAD");
}

MaybeAnswer httpGet(std::string_view url, std::string_view target, std::string_view header) {
  HttpConnection connection(url);
  if (!connection.open()) return {};
  return connection.request(target, "GET", header);
}

bool ipv6LoopbackExists() {
  const int probe = ::socket(AF_INET6, SOCK_STREAM, 0);
  if (probe < 0) return false;
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_addr = in6addr_loopback;
  const bool exists = ::bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(probe);
  return exists;
}

}  // namespace terrane::test

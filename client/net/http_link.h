#pragma once
// One TCP connection to the server for its whole life: connect, one GET after another, close. Used from the fetch
// queue's I/O thread only. The seam around Beast: nothing of it shows here.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "client/net/fetch_queue.h"
#include "client/net/server_url.h"

namespace boost::asio {
class io_context;
}

namespace terrane {

struct HttpLimits {
  std::chrono::milliseconds timeout{30'000};  ///< without progress; four times that for a whole request
  std::size_t maxBodyBytes = 16u << 20;
  std::function<void(std::size_t)> received;  ///< called with every handful of bytes that comes in
};

struct HttpAnswer {
  FetchResponse response;
  std::size_t bytes = 0;  ///< came from the server, headers included
  bool keep = false;      ///< the connection may carry another request
};

class HttpLink {
 public:
  virtual ~HttpLink() = default;
  /// done runs once, from the I/O thread, unless close() came first. Precondition: no request is running.
  virtual void get(const std::string& target, std::function<void(HttpAnswer)> done) = 0;
  /// What the running request still has to bring costs less than a new connection.
  virtual bool cheapToFinish() const = 0;
  /// It has carried an answer before: the server may have closed it since, which says nothing about the server.
  virtual bool used() const = 0;
  /// What has come of the running request's answer so far, headers included.
  virtual std::size_t bytesReceived() const = 0;
  virtual void close() = 0;
};

std::shared_ptr<HttpLink> makeHttpLink(boost::asio::io_context& io, const ServerUrl& server, const HttpLimits& limits);

}  // namespace terrane

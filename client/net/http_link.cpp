#include "client/net/http_link.h"

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <charconv>
#include <optional>
#include <utility>

namespace terrane {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Clock = std::chrono::steady_clock;
using tcp = net::ip::tcp;

constexpr std::uint32_t kHeaderLimitBytes = 16u << 10;
constexpr std::uint64_t kCheapToFinishBytes = 64u << 10;  // about one round trip's worth of a slow start
constexpr std::chrono::seconds kLongestRetryAfter{60};
constexpr int kWholeRequestTimeouts = 4;

/// Seconds; the date form and nonsense count as one second.
std::chrono::milliseconds readRetryAfter(std::string_view value) {
  if (value.empty()) return std::chrono::milliseconds(0);
  unsigned seconds = 0;
  const auto [end, failure] = std::from_chars(value.data(), value.data() + value.size(), seconds);
  if (failure == std::errc::result_out_of_range) return kLongestRetryAfter;
  if (failure != std::errc() || end != value.data() + value.size()) return std::chrono::seconds(1);
  return std::min<std::chrono::milliseconds>(kLongestRetryAfter, std::chrono::seconds(seconds));
}

Error describe(const beast::error_code& code, std::string_view doing) {
  const std::string text = std::string(doing) + ": " + code.message();
  if (code == beast::error::timeout)
    return makeError(ErrorKind::Timeout, "", std::string(doing) + ": no answer in time");
  if (code == http::error::body_limit) return makeError(ErrorKind::TooLarge, "body", text);
  if (code == http::error::end_of_stream || code == http::error::partial_message) {
    return makeError(ErrorKind::Io, "", std::string(doing) + ": the server closed the connection");
  }
  if (code.category() == http::make_error_code(http::error::bad_version).category()) {
    return makeError(ErrorKind::Malformed, "", "what answers does not speak HTTP: " + code.message());
  }
  return makeError(ErrorKind::Io, "", text);
}

class BeastLink final : public HttpLink, public std::enable_shared_from_this<BeastLink> {
 public:
  BeastLink(net::io_context& io, const ServerUrl& server, const HttpLimits& limits)
      : server_(server), limits_(limits), resolver_(io), stream_(io) {
    request_.method(http::verb::get);
    request_.version(11);
    request_.set(http::field::host, server_.authority());
    request_.set(http::field::user_agent, "terrane-view");
    request_.set(http::field::accept, "*/*");
  }

  void get(const std::string& target, std::function<void(HttpAnswer)> done) override {
    done_ = std::move(done);
    answer_ = HttpAnswer();
    deadline_ = Clock::now() + kWholeRequestTimeouts * limits_.timeout;
    request_.target(target);
    parser_.emplace();
    parser_->body_limit(limits_.maxBodyBytes);
    parser_->header_limit(kHeaderLimitBytes);
    parser_->eager(true);
    sent_ = false;
    if (connected_) {
      write();
    } else {
      connect();
    }
  }

  bool cheapToFinish() const override {
    if (!done_ || !sent_ || !parser_->is_header_done()) return false;
    const auto& message = parser_->get();
    const auto field = message[http::field::content_length];
    std::uint64_t length = 0;
    const auto [end, failure] = std::from_chars(field.data(), field.data() + field.size(), length);
    return failure == std::errc() &&
           length - std::min<std::uint64_t>(length, message.body().size()) <= kCheapToFinishBytes;
  }

  bool used() const override { return used_; }
  std::size_t bytesReceived() const override { return answer_.bytes; }

  void close() override {
    done_ = nullptr;
    closed_ = true;
    resolver_.cancel();
    stream_.close();
  }

 private:
  void armTimer() { stream_.expires_at(std::min(deadline_, Clock::now() + limits_.timeout)); }

  void connect() {
    beast::error_code notLiteral;
    const auto address = net::ip::make_address(server_.host, notLiteral);
    if (!notLiteral) {
      armTimer();
      stream_.async_connect(tcp::endpoint(address, server_.port),
                            [self = shared_from_this()](const beast::error_code& code) { self->onConnect(code); });
      return;
    }
    resolver_.async_resolve(
        server_.host, std::to_string(server_.port), tcp::resolver::numeric_service,
        [self = shared_from_this()](const beast::error_code& code, const tcp::resolver::results_type& found) {
          if (self->closed_) return;
          if (code) return self->fail(code, "cannot find " + self->server_.host);
          self->armTimer();
          self->stream_.async_connect(
              found, [self](const beast::error_code& failed, const tcp::endpoint&) { self->onConnect(failed); });
        });
  }

  void onConnect(const beast::error_code& code) {
    if (closed_) return;
    if (code) return fail(code, "cannot connect");
    connected_ = true;
    beast::error_code ignored;
    stream_.socket().set_option(tcp::no_delay(true), ignored);
    write();
  }

  void write() {
    armTimer();
    sent_ = true;
    http::async_write(stream_, request_, [self = shared_from_this()](const beast::error_code& code, std::size_t) {
      if (self->closed_) return;
      if (code) return self->fail(code, "cannot send");
      self->read();
    });
  }

  void read() {
    armTimer();
    http::async_read_some(stream_, buffer_, *parser_,
                          [self = shared_from_this()](const beast::error_code& code, std::size_t bytes) {
                            if (self->closed_) return;
                            self->answer_.bytes += bytes;
                            self->limits_.received(bytes);
                            if (code) return self->fail(code, "cannot receive");
                            if (!self->parser_->is_done()) return self->read();
                            self->succeed();
                          });
  }

  void succeed() {
    // Bytes after the answer belong to nothing that was asked for.
    answer_.keep = parser_->keep_alive() && buffer_.size() == 0;
    auto message = parser_->release();
    answer_.response.status = static_cast<int>(message.result_int());
    answer_.response.retryAfter =
        readRetryAfter({message[http::field::retry_after].data(), message[http::field::retry_after].size()});
    answer_.response.body = std::move(message.body());
    used_ = true;
    finish();
  }

  void fail(const beast::error_code& code, std::string_view doing) {
    answer_.bytes += buffer_.size();
    answer_.keep = false;
    answer_.response.status = 0;
    answer_.response.error = describe(code, doing);
    finish();
  }

  void finish() {
    stream_.expires_never();
    auto done = std::exchange(done_, nullptr);
    if (done) done(std::move(answer_));
  }

  ServerUrl server_;
  HttpLimits limits_;
  tcp::resolver resolver_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request<http::empty_body> request_;
  std::optional<http::response_parser<http::vector_body<std::uint8_t>>> parser_;
  std::function<void(HttpAnswer)> done_;
  HttpAnswer answer_;
  Clock::time_point deadline_;
  bool connected_ = false, sent_ = false, used_ = false, closed_ = false;
};

}  // namespace

std::shared_ptr<HttpLink> makeHttpLink(net::io_context& io, const ServerUrl& server, const HttpLimits& limits) {
  return std::make_shared<BeastLink>(io, server, limits);
}

}  // namespace terrane

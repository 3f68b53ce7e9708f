#pragma once
// A small blocking HTTP/1.1 client over a raw socket, so that tests can send what no library would: half requests,
// wrong bytes, silence. Every read ends after ten seconds.

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace terrane::test {

struct HttpAnswer {
  int status = 0;
  std::map<std::string, std::string> fields;  ///< names in lower case
  std::string body;
};

/// An answer or none; none reads as an answer of status 0 without fields, so that a test that goes on fails rather than
/// crashes.
class MaybeAnswer {
 public:
  MaybeAnswer() = default;
  MaybeAnswer(HttpAnswer answer) : answer_(std::move(answer)), given_(true) {}
  explicit operator bool() const { return given_; }
  const HttpAnswer* operator->() const { return &answer_; }

 private:
  HttpAnswer answer_;
  bool given_ = false;
};

/// One connection to "http://127.0.0.1:1234" or "http://[::1]:1234".
class HttpConnection {
 public:
  explicit HttpConnection(std::string_view url);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  bool open() const { return socket_ >= 0; }
  void send(std::string_view bytes);
  void shutdownSend();
  void close();
  /// Closes with a reset instead of a farewell.
  void abort();
  /// The next answer; empty if the server closed first or sent something else. withBody: false for an answer to HEAD.
  MaybeAnswer read(bool withBody = true);
  /// True if the server closes the connection within the time limit without sending anything more.
  bool closedByServer();
  /// Sends "METHOD target" with a Host field and further header lines ("Name: value\r\n"), and reads the answer.
  MaybeAnswer request(std::string_view target, std::string_view method = "GET", std::string_view header = {});

 private:
  bool fill();

  int socket_ = -1;
  std::string input_;
};

/// One request over a connection of its own.
MaybeAnswer httpGet(std::string_view url, std::string_view target, std::string_view header = {});

/// Whether this machine has the IPv6 loopback address.
bool ipv6LoopbackExists();

}  // namespace terrane::test

#pragma once
// The Date field of a response (RFC 9110 section 5.6.7), written once a second. Not thread-safe: one for each I/O
// thread.

#include <ctime>
#include <string>
#include <string_view>

namespace terrane {

/// "Sun, 06 Nov 1994 08:49:37 GMT"
std::string httpDate(std::time_t secondsSinceEpoch);

/// What ends a response's head: Date, Connection where it is needed, and the blank line.
class HeadEndings {
 public:
  enum class Connection { KeptByDefault, Kept, Closed };
  /// Valid until the next call.
  std::string_view at(std::time_t now, Connection connection);

 private:
  std::time_t written_ = -1;
  std::string texts_[3];
};

}  // namespace terrane

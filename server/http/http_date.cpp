#include "server/http/http_date.h"

#include <fmt/format.h>

#include <array>

namespace terrane {

std::string httpDate(std::time_t secondsSinceEpoch) {
  static constexpr std::array kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  static constexpr std::array kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                      "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  std::tm utc{};
  gmtime_r(&secondsSinceEpoch, &utc);
  return fmt::format("{}, {:02} {} {} {:02}:{:02}:{:02} GMT", kDays[static_cast<std::size_t>(utc.tm_wday)], utc.tm_mday,
                     kMonths[static_cast<std::size_t>(utc.tm_mon)], utc.tm_year + 1900, utc.tm_hour, utc.tm_min,
                     utc.tm_sec);
}

std::string_view HeadEndings::at(std::time_t now, Connection connection) {
  if (now != written_) {
    written_ = now;
    const std::string date = "Date: " + httpDate(now) + "\r\n";
    texts_[0] = date + "\r\n";
    texts_[1] = date + "Connection: keep-alive\r\n\r\n";
    texts_[2] = date + "Connection: close\r\n\r\n";
  }
  return texts_[static_cast<std::size_t>(connection)];
}

}  // namespace terrane

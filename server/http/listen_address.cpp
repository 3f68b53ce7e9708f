#include "server/http/listen_address.h"

#include <fmt/format.h>

#include <charconv>

namespace terrane {

Result<ListenAddress> parseListenAddress(std::string_view text) {
  const auto wrong = [&](std::string_view what) {
    return makeError(ErrorKind::InvalidArgument, "--listen",
                     fmt::format("\"{}\" {}; write HOST:PORT, as in 127.0.0.1:8080, 0.0.0.0:8080 or [::1]:8080",
                                 text.substr(0, 80), what));
  };
  ListenAddress address;
  std::string_view portText;
  if (text.starts_with('[')) {
    const std::size_t end = text.find("]:");
    if (end == std::string_view::npos) return wrong("has no \"]:\" between host and port");
    address.host = text.substr(1, end - 1);
    portText = text.substr(end + 2);
    if (address.host.find(':') == std::string::npos) return wrong("has no IPv6 address in its brackets");
  } else {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return wrong("has no port");
    if (text.find(':', colon + 1) != std::string_view::npos)
      return wrong("has more than one colon (an IPv6 address needs brackets)");
    address.host = text.substr(0, colon);
    portText = text.substr(colon + 1);
  }
  if (address.host.empty()) return wrong("has no host");
  const auto [rest, failure] = std::from_chars(portText.data(), portText.data() + portText.size(), address.port);
  if (portText.empty() || failure != std::errc() || rest != portText.data() + portText.size())
    return wrong("has no port from 0 to 65535");
  return address;
}

}  // namespace terrane

#pragma once
// Where a server is, as a user writes it: http://host[:port][/], host a name, an IPv4 address or an IPv6 address in
// brackets. Thread-safe.

#include <cstdint>
#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

struct ServerUrl {
  std::string host;  ///< without brackets
  std::uint16_t port = 80;

  /// "host:port" as the Host header has it: brackets around an IPv6 address, no port if it is 80.
  std::string authority() const;
  /// "http://host:port", always with the port: the name of this server in messages and in the disk cache.
  std::string origin() const;
};

/// Errors: InvalidArgument naming "--server".
Result<ServerUrl> parseServerUrl(std::string_view text);

}  // namespace terrane

#pragma once
// Where to listen, as a user writes it: "127.0.0.1:8080", "[::1]:0", "localhost:8080". Thread-safe.

#include <cstdint>
#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

struct ListenAddress {
  std::string host;  ///< a name or an address, without brackets
  std::uint16_t port = 0;
};

/// Errors (InvalidArgument) name "--listen".
Result<ListenAddress> parseListenAddress(std::string_view text);

}  // namespace terrane

#pragma once
// Sizes in bytes as a user writes them at the command line. Thread-safe.

#include <cstddef>
#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

/// "256MiB", "1.5 GiB", "64KiB", "1000000" (bytes), "500MB" (10^6); rounded down to whole bytes. Errors
/// (InvalidArgument, TooLarge) name the given field.
Result<std::size_t> parseByteSize(std::string_view text, std::string_view field);

/// "256 MiB", with one decimal where it is not whole.
std::string formatByteSize(std::size_t bytes);

}  // namespace terrane

#pragma once
// The file of --config: flags and their values. Thread-safe.
//
//   scene = "moon"                       # or without quotes; ; begins a comment too
//   listen = ["127.0.0.1:8080", "[::1]:8080"]
//   check                                # a switch: as check = true
//
// The part of TOML that flags need, and of INI files what is not TOML. What the flags mean is the command line's to
// say.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"

namespace terrane {

struct ConfigEntry {
  std::string key;                  ///< without dashes
  std::vector<std::string> values;  ///< none are empty
  std::size_t line = 0;
};

/// Errors: one printable line, complete in message: "terrane.toml:4: threads: has no value".
Result<std::vector<ConfigEntry>> parseConfig(std::string_view text, std::string_view fileName);
/// Errors also: Io naming "--config".
Result<std::vector<ConfigEntry>> readConfigFile(const std::string& file);

}  // namespace terrane

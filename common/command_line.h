#pragma once
// What the command lines of both programs have in common. Thread-safe.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

inline constexpr int kExitDone = 0, kExitFailed = 1, kExitWrongUsage = 2;

/// For --help.
inline constexpr const char* kExitStatusHelp =
    "Exit status\n  0  done\n  1  it failed: a port in use, no server, a file that cannot be written, ...\n"
    "  2  wrong usage: an unknown flag, or a value or file given to a flag that is of no use\n";

/// kExitWrongUsage for InvalidArgument, kExitFailed for everything else.
int exitStatus(const Error& error) noexcept;

/// "program: text" as one line on stderr: control characters escaped, and lost where nothing can be written.
void complain(std::string_view program, std::string_view text) noexcept;

enum class FlagKind : std::uint8_t { Unknown, Switch, TakesValue };

/// Before a parser takes the words (without the program's name): a flag that needs a value must not be followed by
/// another flag, which would be taken for the value, nor by nothing at all as in --flag="". What begins with one dash
/// only is a value: longitudes are negative. A switch must be given none. Errors: InvalidArgument naming the flag.
Result<void> checkFlagValues(std::span<const std::string> words,
                             const std::function<FlagKind(std::string_view flag)>& kindOf);

}  // namespace terrane

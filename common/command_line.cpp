#include "common/command_line.h"

namespace terrane {

int exitStatus(const Error& error) noexcept {
  return error.kind == ErrorKind::InvalidArgument ? kExitWrongUsage : kExitFailed;
}

Result<void> checkFlagValues(std::span<const std::string> words,
                             const std::function<bool(std::string_view flag)>& needsValue) {
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    const std::string_view word = words[i];
    const std::size_t equals = word.find('=');
    const std::string flag(word.substr(0, equals));
    if (!word.starts_with("--") || !needsValue(flag)) continue;
    const bool separate = equals == std::string_view::npos;
    if (separate && i + 1 == words.size()) break;  // the parser says so
    const std::string_view value = separate ? std::string_view(words[++i]) : word.substr(equals + 1);
    if (value.empty()) return makeError(ErrorKind::InvalidArgument, flag, "its value is empty");
    if (separate && value.starts_with("--"))
      return makeError(
          ErrorKind::InvalidArgument, flag,
          "needs a value, and " + quotedForMessage(value) + " follows (a value like that: " + flag + "=...)");
  }
  return {};
}

}  // namespace terrane

#include "common/command_line.h"

#include <cstdio>

namespace terrane {

int exitStatus(const Error& error) noexcept {
  return error.kind == ErrorKind::InvalidArgument ? kExitWrongUsage : kExitFailed;
}

void complain(std::string_view program, std::string_view text) noexcept {
  std::fprintf(stderr, "%.*s: ", static_cast<int>(program.size()), program.data());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // In UTF-8 the control characters from U+0080 on are C2 80 .. C2 9F.
    const bool secondControls = byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (byte < 0x20 || byte == 0x7F || secondControls)
      std::fprintf(stderr, "\\x%02x", byte);
    else
      std::fputc(text[i], stderr);
  }
  std::fputc('\n', stderr);
}

Result<void> checkFlagValues(std::span<const std::string> words,
                             const std::function<FlagKind(std::string_view flag)>& kindOf) {
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    const std::string_view word = words[i];
    const std::size_t equals = word.find('=');
    const std::string flag(word.substr(0, equals));
    const FlagKind kind = word.starts_with("--") ? kindOf(flag) : FlagKind::Unknown;
    const bool separate = equals == std::string_view::npos;
    if (kind == FlagKind::Switch && !separate)
      return makeError(ErrorKind::InvalidArgument, flag,
                       "takes no value, and is given " + quotedForMessage(word.substr(equals + 1)));
    if (kind != FlagKind::TakesValue) continue;
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
